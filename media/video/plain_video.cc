#include "media/video/plain_video.h"

#include <cmath>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::media {

PlainVideo::PlainVideo(const std::filesystem::path& path, cv::Size size, double fps)
    : path_(path),
      size_(size),
      file_(path, std::ios::binary | std::ios::trunc),
      planes_(static_cast<std::size_t>(size.area()) * 3 / 2) {
  file_ << fmt::format("YUV4MPEG2 W{} H{} F{}:1000 Ip A1:1 C420jpeg XCOLORRANGE=LIMITED\n", size.width,
                       size.height, std::lround(1000 * fps));
  if (!file_)
    throw Error(ErrorKind::kIo, path.string(), "cannot be written", "Check the folder and the disk");
}

// BT.601 in 16.16 fixed point; 4:2:0 takes the mean of four pixels.
void PlainVideo::write(const cv::Mat& bgr) {
  const int w = size_.width, h = size_.height;
  std::uint8_t* const luma = planes_.data();
  std::uint8_t* const blue = luma + static_cast<std::ptrdiff_t>(w) * h;
  std::uint8_t* const red = blue + static_cast<std::ptrdiff_t>(w) * h / 4;
  for (int y = 0; y < h; ++y) {
    const cv::Vec3b* row = bgr.ptr<cv::Vec3b>(y);
    for (int x = 0; x < w; ++x)
      luma[y * w + x] = static_cast<std::uint8_t>(
          16 + ((16829 * row[x][2] + 33039 * row[x][1] + 6416 * row[x][0] + (1 << 15)) >> 16));
  }
  for (int y = 0; y < h / 2; ++y) {
    const cv::Vec3b *above = bgr.ptr<cv::Vec3b>(2 * y), *below = bgr.ptr<cv::Vec3b>(2 * y + 1);
    for (int x = 0; x < w / 2; ++x) {
      int sum[3];
      for (int c = 0; c < 3; ++c)
        sum[c] = above[2 * x][c] + above[2 * x + 1][c] + below[2 * x][c] + below[2 * x + 1][c];
      blue[y * w / 2 + x] = static_cast<std::uint8_t>(
          128 + ((28784 * sum[0] - 19071 * sum[1] - 9713 * sum[2] + (1 << 17)) >> 18));
      red[y * w / 2 + x] = static_cast<std::uint8_t>(
          128 + ((28784 * sum[2] - 24103 * sum[1] - 4681 * sum[0] + (1 << 17)) >> 18));
    }
  }
  file_ << "FRAME\n";
  file_.write(reinterpret_cast<const char*>(planes_.data()), static_cast<std::streamsize>(planes_.size()));
}

void PlainVideo::finish() {
  file_.close();
  if (!file_)
    throw Error(ErrorKind::kIo, path_.string(), "cannot be written to its end", "Free space on the disk");
}

}  // namespace freshet::media
