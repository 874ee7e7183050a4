#include "media/video/picture_sink.h"

#include <cmath>
#include <cstdint>

#include "media/picture/picture.h"

namespace freshet::media {
PictureSink::PictureSink(const std::filesystem::path& path, cv::Size size, int frames, double fps,
                         const VideoWriterOptions& options)
    : path_(path), format_(output_format(path, frames)), exr_(options.exr), bits_(options.bits) {
  // Rates such as 29.97 to a thousandth: exact enough for a player, and small enough for every container.
  VideoWriterOptions timed = options;
  timed.fps_num = std::llround(fps * 1000);
  timed.fps_den = 1000;
  if (format_.form() != OutputFormat::Form::kPicture) writer_.emplace(path, size, timed);
}

void PictureSink::check(const std::filesystem::path& path, cv::Size size, int frames, double fps) {
  PictureSink(path, size, frames, fps);  // what was begun is removed again
}

void PictureSink::write(const cv::Mat& picture) {
  const cv::Mat held = as_held(picture, format_, bits_);
  if (writer_)
    writer_->write(held);
  else if (held.depth() == CV_32F)
    write_exr_picture(path_, held, exr_);
  else
    write_picture(path_, held);
}

void PictureSink::finish() {
  if (writer_) writer_->finish();
}

}  // namespace freshet::media
