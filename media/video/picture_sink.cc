#include "media/video/picture_sink.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"

namespace freshet::media {
namespace {

bool is_one_picture(const std::filesystem::path& path, int frames) {
  static constexpr std::array kEndings{".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".exr"};
  return frames == 1 && !is_pattern(path) &&
         std::find(kEndings.begin(), kEndings.end(), path.extension()) != kEndings.end();
}

}  // namespace

PictureSink::PictureSink(const std::filesystem::path& path, cv::Size size, int frames, double fps,
                         const VideoWriterOptions& options)
    : path_(path), exr_(options.exr) {
  // Rates such as 29.97 to a thousandth: exact enough for a player, and small enough for every container.
  VideoWriterOptions timed = options;
  timed.fps_num = std::llround(fps * 1000);
  timed.fps_den = 1000;
  if (!is_one_picture(path, frames)) writer_.emplace(path, size, timed);
}

void PictureSink::check(const std::filesystem::path& path, cv::Size size, int frames, double fps) {
  PictureSink(path, size, frames, fps);  // what was begun is removed again
}

void PictureSink::write(const cv::Mat& picture) {
  if (writer_)
    writer_->write(picture);
  else if (picture.depth() == CV_32F)
    write_exr_picture(path_, picture, exr_);
  else
    write_picture(path_, picture);
}

void PictureSink::finish() {
  if (writer_) writer_->finish();
}

}  // namespace freshet::media
