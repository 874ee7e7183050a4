// synth/scene/rendering/footage_reader.h — a sequence or video with alpha, frame by frame, round and round.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "media/video/video_reader.h"

namespace freshet::synth::scene {

/// Sequences of .png keep their 16 bits; all else is taken at 8. What has no alpha is opaque.
class FootageReader {
 public:
  /// width   px of its frames, which keep their shape; 0: as they are.
  /// Throws Error{kInput} naming the file, as VideoReader and read_deep_picture do.
  explicit FootageReader(const std::filesystem::path& file, int width = 0);
  /// The next frame, after the last the first: CV_32FC4, sRGB code times alpha, and alpha; valid until the next call.
  /// Throws   Error{kInput}: frames of unequal size, none that can be decoded.
  const cv::Mat& next();
  /// Whether next() would give the first frame; of a video known once its last was asked for.
  bool at_end();

 private:
  const cv::Mat& taken(const cv::Mat& bgra, double white);

  std::filesystem::path file_;
  int width_;
  std::vector<std::filesystem::path> pictures_;  // of a sequence
  std::size_t picture_ = 0;
  std::optional<media::VideoReader> reader_;
  std::optional<media::Frame> ahead_;  // of the video, read and not yet given
  cv::Mat frame_, sized_;
};

}  // namespace freshet::synth::scene
