#include "media/picture/light.h"

#include <cmath>

namespace freshet::media {
namespace {

cv::Mat through(const cv::Mat& values, float (*curve)(float)) {
  cv::Mat out(values.size(), CV_32FC3);
  for (int y = 0; y < values.rows; ++y) {
    const float* from = values.ptr<float>(y);
    float* to = out.ptr<float>(y);
    for (int i = 0; i < 3 * values.cols; ++i) to[i] = curve(from[i]);
  }
  return out;
}

}  // namespace

float linear_of(float coded) {
  const float c = std::abs(coded);
  return std::copysign(c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f), coded);
}

float coded_of(float linear) {
  const float l = std::abs(linear);
  return std::copysign(l <= 0.0031308f ? 12.92f * l : 1.055f * std::pow(l, 1 / 2.4f) - 0.055f, linear);
}

cv::Mat to_linear(const cv::Mat& coded) { return through(coded, linear_of); }
cv::Mat to_coded(const cv::Mat& linear) { return through(linear, coded_of); }

}  // namespace freshet::media
