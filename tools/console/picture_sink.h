// tools/console/picture_sink.h — where rendered frames go: a video, a sequence, or one picture.
#pragma once

#include <filesystem>
#include <optional>

#include "media/video/video_writer.h"

namespace freshet::tools {

/// A single frame with a picture's ending becomes that picture; everything else goes through VideoWriter.
class PictureSink {
 public:
  PictureSink(const std::filesystem::path& path, cv::Size size, int frames, double fps);
  void write(const cv::Mat& picture);
  void finish();

 private:
  std::filesystem::path path_;
  std::optional<media::VideoWriter> writer_;
};

}  // namespace freshet::tools
