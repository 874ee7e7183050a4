#include "freshet/picture.h"

#include <utility>

#include "media/picture/picture.h"
#include "media/video/picture_sink.h"

namespace freshet {

Picture read_picture(const std::filesystem::path& path) {
  media::Still read = media::read_still(path);
  return {.bgr = read.bgr, .deep = read.deep, .notices = std::move(read.notices)};
}

Matte read_matte(const std::filesystem::path& path, cv::Size size) {
  media::Matte read = media::read_matte(path, size);
  return {.alpha = read.alpha, .notices = std::move(read.notices)};
}

struct VideoWriter::Impl {
  media::PictureSink sink;
};

VideoWriter::VideoWriter(const std::filesystem::path& path, cv::Size size, const VideoOptions& options)
    : impl_(std::make_unique<Impl>(media::PictureSink(path, size, options.frames, options.fps))) {}
VideoWriter::~VideoWriter() = default;

void VideoWriter::write(const cv::Mat& frame) {
  if (frame.channels() != 1) return impl_->sink.write(frame);
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>(3, frame), colour);
  impl_->sink.write(colour);
}

void VideoWriter::finish() { impl_->sink.finish(); }

}  // namespace freshet
