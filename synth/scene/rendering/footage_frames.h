// synth/scene/rendering/footage_frames.h — a sequence or video with alpha as a layer, for as long as the scene lasts.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/rendering/footage_reader.h"
#include "synth/scene/rendering/layer_frames.h"

namespace freshet::synth::scene {

/// How often footage begins anew in a scene, and how it goes over from its old course into the new one.
struct FootageCourse {
  std::vector<int> lengths;  // frames of each course; the scene's together
  int fade = 0;            // frames at the beginning of a course, in which the one before it goes on below it
  bool from_last = false;  // the first course has the last before it: a loop
};

/// scene_frames, loop   of the scene. footage_frames   at least 1; what is more than the scene and kFadeMost needs need
/// not be counted. comes_round   its last frame runs into its first: it may go on for ever.
FootageCourse footage_course(int scene_frames, bool loop, int footage_frames, bool comes_round);
inline constexpr int kFadeMost = 24;  // frames

/// Plays the file; where it is shorter than the scene, and in a loop, its end goes over into its beginning, and nothing
/// jumps. Never backwards: water would rise.
class FootageFrames : public LayerFrames {
 public:
  /// Reads the file once, as far as the scene lasts, to know its length. width   as FootageReader. Throws as it does.
  FootageFrames(const std::filesystem::path& file, cv::Point at, int scene_frames, bool loop, int width = 0);
  const cv::Mat& next() override;
  cv::Point at() const override { return at_; }

 private:
  std::filesystem::path file_;
  cv::Point at_;
  int width_;
  FootageCourse course_;
  std::size_t which_ = 0;                            // course
  int place_ = 0;                                    // in it
  std::unique_ptr<FootageReader> before_, playing_;  // before_: of the course before, while it fades
  cv::Mat frame_;
};

}  // namespace freshet::synth::scene
