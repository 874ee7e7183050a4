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
  static constexpr std::array kEndings{".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp"};
  return frames == 1 && !is_pattern(path) &&
         std::find(kEndings.begin(), kEndings.end(), path.extension()) != kEndings.end();
}

}  // namespace

PictureSink::PictureSink(const std::filesystem::path& path, cv::Size size, int frames, double fps)
    : path_(path) {
  // Rates such as 29.97 to a thousandth: exact enough for a player, and small enough for every container.
  if (!is_one_picture(path, frames))
    writer_.emplace(path, size, VideoWriterOptions{.fps_num = std::llround(fps * 1000), .fps_den = 1000});
}

void PictureSink::check(const std::filesystem::path& path, cv::Size size, int frames, double fps) {
  PictureSink(path, size, frames, fps);  // what was begun is removed again
}

void PictureSink::write(const cv::Mat& picture) {
  if (writer_)
    writer_->write(picture);
  else
    write_picture(path_, picture);
}

void PictureSink::finish() {
  if (writer_) writer_->finish();
}

}  // namespace freshet::media
