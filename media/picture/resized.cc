#include "media/picture/resized.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace freshet::media {
namespace {

/// Floats, 0..1 for whole numbers.
cv::Mat floats(const cv::Mat& frame) {
  cv::Mat out;
  frame.convertTo(out, CV_32F,
                  frame.depth() == CV_8U    ? 1.0 / 255
                  : frame.depth() == CV_16U ? 1.0 / 65535
                                            : 1);
  return out;
}

void premultiply(cv::Mat& frame) {
  frame.forEach<cv::Vec4f>([](cv::Vec4f& pixel, const int*) {
    for (int c = 0; c < 3; ++c) pixel[c] *= pixel[3];
  });
}

void divide(cv::Mat& frame) {
  frame.forEach<cv::Vec4f>([](cv::Vec4f& pixel, const int*) {
    for (int c = 0; c < 3; ++c) pixel[c] = pixel[3] > 0 ? pixel[c] / pixel[3] : 0;
  });
}

/// Lanczos swings beyond what is there: no alpha above 1, no colour below 0.
void settle(cv::Mat& frame) {
  cv::max(frame, 0, frame);
  if (frame.channels() == 4)
    frame.forEach<cv::Vec4f>([](cv::Vec4f& pixel, const int*) { pixel[3] = std::min(pixel[3], 1.0f); });
}

}  // namespace

cv::Mat resized(const cv::Mat& frame, cv::Size size, Colours colours) {
  if (frame.size() == size) return frame;
  const bool shrinks = size.width <= frame.cols && size.height <= frame.rows;
  const int way = shrinks ? cv::INTER_AREA : cv::INTER_LANCZOS4;
  cv::Mat out;
  const bool straight = frame.channels() == 4 && colours == Colours::kStraight;
  if (!straight && frame.depth() != CV_32F) {
    cv::resize(frame, out, size, 0, 0, way);  // which ends at the range's ends
    return out;
  }
  cv::Mat light = floats(frame);
  if (straight) premultiply(light);
  cv::resize(light, out, size, 0, 0, way);
  settle(out);
  if (straight) divide(out);
  out.convertTo(out, frame.depth(), frame.depth() == CV_8U ? 255 : frame.depth() == CV_16U ? 65535 : 1);
  return out;
}

}  // namespace freshet::media
