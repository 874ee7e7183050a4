#include "query/search/picture_scale.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"

namespace freshet::query {
namespace {

constexpr double kSearchedPx = 1280, kStep = 0.5;

}  // namespace

double auto_piece_scale(cv::Size picture) {
  const double scale = std::max(picture.width, picture.height) / kSearchedPx;
  return std::clamp(std::round(scale / kStep) * kStep, 1.0, kMaxPieceScale);
}

cv::Size reduced_size(cv::Size picture, double scale) {
  if (!(scale >= 1)) throw Error(ErrorKind::kUsage, "scale " + std::to_string(scale), "at least 1 expected");
  return {std::max(1, static_cast<int>(std::lround(picture.width / scale))),
          std::max(1, static_cast<int>(std::lround(picture.height / scale)))};
}

cv::Mat reduce(const cv::Mat& picture, double scale) {
  const cv::Size size = reduced_size(picture.size(), scale);
  if (size == picture.size()) return picture;
  cv::Mat out;
  cv::resize(picture, out, size, 0, 0, cv::INTER_AREA);
  return out;
}

MotionGuide reduce(const MotionGuide& guide, double scale) {
  MotionGuide out = guide;
  if (!guide.direction.empty()) {
    out.direction = reduce(guide.direction, scale);
    if (scale != 1)
      for (int y = 0; y < out.direction.rows; ++y)
        for (int x = 0; x < out.direction.cols; ++x) {
          cv::Vec2f& way = out.direction.at<cv::Vec2f>(y, x);
          const float length = std::hypot(way[0], way[1]);
          way = length > 1e-3f ? way / length : cv::Vec2f(0, 0);
        }
  }
  if (!guide.speed.empty() && scale != 1) {
    // Negative is no speed: only what is asked counts, and the fraction of it says whether anything is.
    const cv::Mat asked = guide.speed >= 0;
    cv::Mat fraction;
    asked.convertTo(fraction, CV_32F, 1.0 / 255);
    const cv::Mat sum = reduce(cv::max(guide.speed, 0.0f).mul(fraction), scale),
                  mass = reduce(fraction, scale);
    out.speed.create(sum.size(), CV_32F);
    for (int y = 0; y < sum.rows; ++y)
      for (int x = 0; x < sum.cols; ++x) {
        const float m = mass.at<float>(y, x);
        out.speed.at<float>(y, x) = m > 1e-3f ? sum.at<float>(y, x) / m / static_cast<float>(scale) : -1.0f;
      }
  }
  if (out.horizon)
    for (cv::Point2f* end : {&out.horizon->from, &out.horizon->to}) *end /= static_cast<float>(scale);
  return out;
}

}  // namespace freshet::query
