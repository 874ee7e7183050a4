// synth/scene/rendering/footage_frames.h — a sequence or video with alpha as a layer.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "media/video/video_reader.h"
#include "synth/scene/rendering/layer_frames.h"

namespace freshet::synth::scene {

/// Plays the file, and again from its beginning where it is shorter. Sequences of .png keep their 16 bits; all else is
/// taken at 8. What has no alpha is opaque.
class FootageFrames : public LayerFrames {
 public:
  /// Throws Error{kInput} naming the file, as VideoReader and read_deep_picture do; frames of unequal size.
  FootageFrames(const std::filesystem::path& file, cv::Point at);
  const cv::Mat& next() override;
  cv::Point at() const override { return at_; }

 private:
  std::filesystem::path file_;
  cv::Point at_;
  std::vector<std::filesystem::path> pictures_;  // of a sequence
  std::size_t picture_ = 0;
  std::optional<media::VideoReader> reader_;
  cv::Mat frame_;
};

}  // namespace freshet::synth::scene
