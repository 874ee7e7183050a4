// synth/scene/frames/footage_frames.h — a sequence or video as a layer, for as long as the scene lasts.
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/frames/footage_reader.h"
#include "synth/scene/rendering/layer_frames.h"
#include "synth/scene/scene.h"

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

/// Plays the file from its start on; where it is shorter than what is left of the scene, and in a loop, its end goes
/// over into its beginning, and nothing jumps. Never backwards: water would rise. What plays once is not there before
/// its start and after its end, in a loop a whole round after its start at the latest.
class FootageFrames : public LayerFrames {
 public:
  /// Reads the file once, as far as the scene lasts, to know its length; and in a loop, in which it starts later, on to
  /// the frame that the scene begins with. scene_frames, fps, loop   of the scene. Throws as FootageReader, and
  /// Error{kInput} for a matte of another shape than the film, or that is none (media::read_matte), and for mattes
  /// that are fewer or more than the film's frames; Error{kCancelled}.
  FootageFrames(const FootageMotion& footage, int scene_frames, double fps, bool loop,
                const std::stop_token& stop = {});
  const cv::Mat& next() override;
  /// By optical flow (FootageReader::motion), of any FrameWork. 0 for a film of one frame.
  std::optional<cv::Mat> motion() override;
  cv::Point at() const override { return footage_.at; }

 private:
  std::unique_ptr<FootageReader> reader() const;
  const cv::Mat& next_of_course();

  FootageMotion footage_;
  FootageForm form_;
  FootageCourse course_;
  int round_ = 0;                                    // frames after which it comes again; 0: never
  int since_ = 0;                                    // frames since its start; below 0: it is to come
  int shown_ = 0;                                    // frames of a round in which it is there
  std::size_t which_ = 0;                            // course
  int place_ = 0;                                    // in it
  std::unique_ptr<FootageReader> before_, playing_;  // before_: of the course before, while it fades
  bool comes_round_ = false;                         // the film's last frame runs into its first
  FootageReader* leading_ = nullptr;  // of the two, that of which more is seen; null where nothing is
  cv::Mat frame_, motion_;
};

}  // namespace freshet::synth::scene
