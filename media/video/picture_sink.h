// media/video/picture_sink.h — where rendered frames go: a video, a sequence, or one picture.
#pragma once

#include <filesystem>
#include <optional>

#include "media/video/video_writer.h"

namespace freshet::media {

/// As output_format() says: a single frame with a picture's ending becomes that picture; everything else goes through
/// VideoWriter.
class PictureSink {
 public:
  /// options   beside the rate.
  /// Throws as VideoWriter's constructor and, when frames are written, as write_picture.
  PictureSink(const std::filesystem::path& path, cv::Size size, int frames, double fps,
              const VideoWriterOptions& options = {});
  /// Throws what the constructor would, and leaves nothing: for those who compute long before they write.
  static void check(const std::filesystem::path& path, cv::Size size, int frames, double fps);

  /// CV_8U or CV_16U of sRGB code, 3 channels or 4 with straight alpha, brought to what the format holds (as_held); or
  /// CV_32F as VideoWriter takes it. Alpha is refused where the format holds none.
  void write(const cv::Mat& picture);
  void finish();

 private:
  std::filesystem::path path_;
  OutputFormat format_;
  ExrSamples exr_;
  int bits_;  // of H.264
  std::optional<VideoWriter> writer_;
};

}  // namespace freshet::media
