// media/video/plain_video.h — frames as YUV4MPEG2, uncompressed, with the same bytes whatever FFmpeg there is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::media {

/// A .y4m file, 8 bits, 4:2:0, BT.601 at limited range. Everything reads it. Any other container carries its writer's
/// version, and its coder's luck: for files of which a hash is to be the same on every machine.
class PlainVideo {
 public:
  /// size   px, even sides. fps   frames per second, written to a thousandth.
  /// Throws Error{kIo} that names the file.
  PlainVideo(const std::filesystem::path& path, cv::Size size, double fps);
  /// CV_8UC3 BGR of that size. Integers throughout.
  void write(const cv::Mat& bgr);
  /// Throws Error{kIo} where not everything reached the file.
  void finish();

 private:
  std::filesystem::path path_;
  cv::Size size_;
  std::ofstream file_;
  std::vector<std::uint8_t> planes_;
};

}  // namespace freshet::media
