// include/freshet/picture.h — still pictures and mattes from files, and animations to files.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet {

struct Picture {
  cv::Mat bgr;  // CV_8UC3, sRGB code: what is searched with
  /// What bgr was reduced from: CV_16UC3, sRGB code, or CV_32FC3, linear light (EXR). Empty: the file has 8 bits.
  cv::Mat deep;
  std::vector<std::string> notices;  // for a person
};

/// PNG, JPEG, TIFF, EXR, ..., upright. EXR is taken to be linear light of Rec. 709's primaries, all else sRGB, or
/// brought to it from the file's profile. Throws Error{kInput}: missing, no picture, above 1 << 28 px, a profile or
/// primaries that cannot be honoured.
Picture read_picture(const std::filesystem::path& path);

struct Matte {
  cv::Mat alpha;                     // CV_8U, 255 where the fluid is
  std::vector<std::string> notices;  // for a person
};

/// A grey picture, white where the fluid is, or where something stands (SearchOptions::held). size   px, of the
/// picture that it belongs to.
/// Throws Error{kInput}: missing, no picture, of another size, black everywhere.
Matte read_matte(const std::filesystem::path& path, cv::Size size);

struct VideoOptions {
  /// How many frames will be written. One, with the ending of a picture, becomes that picture.
  int frames = 96;
  /// Frames per second; kept to a thousandth.
  double fps = 25;
};

/// A video chosen by its ending: .mp4 (H.264), .mkv (FFV1, lossless), .mov (ProRes 4444, alpha), .webp and
/// .apng (animated), or a numbered sequence such as frames/%05d.png. A file is written beside its place and
/// renamed by finish(): destroyed before, the writer leaves none.
class VideoWriter {
 public:
  /// size   px, of all frames.
  /// Throws Error{kUsage} for an ending it does not know, Error{kIo} for a folder that is not there.
  VideoWriter(const std::filesystem::path& path, cv::Size size, const VideoOptions& options = {});
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;
  ~VideoWriter();

  /// CV_8UC3 BGR, or CV_8U grey; CV_8UC4 straight alpha (not .mp4); CV_16UC3 and CV_16UC4 (.mkv, .mov, .png, .tif);
  /// CV_32FC3 and CV_32FC4, linear light (.exr).
  /// Throws Error{kIo} on a full disk.
  void write(const cv::Mat& frame);
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet
