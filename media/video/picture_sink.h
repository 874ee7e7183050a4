// media/video/picture_sink.h — where rendered frames go: a video, a sequence, or one picture.
#pragma once

#include <filesystem>
#include <optional>

#include "media/video/video_writer.h"

namespace freshet::media {

/// A single frame with a picture's ending becomes that picture; everything else goes through VideoWriter.
class PictureSink {
 public:
  /// options   beside the rate.
  /// Throws as VideoWriter's constructor and, when frames are written, as write_picture.
  PictureSink(const std::filesystem::path& path, cv::Size size, int frames, double fps,
              const VideoWriterOptions& options = {});
  /// Throws what the constructor would, and leaves nothing: for those who compute long before they write.
  static void check(const std::filesystem::path& path, cv::Size size, int frames, double fps);

  void write(const cv::Mat& picture);
  void finish();

 private:
  std::filesystem::path path_;
  ExrSamples exr_;
  std::optional<VideoWriter> writer_;
};

}  // namespace freshet::media
