#include "tests/synth/transfer/made_exemplar.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "platform/random.h"

namespace freshet::synth::transfer {
namespace {

cv::Mat noise(cv::Size size, int cell, std::uint64_t seed) {
  const Random random(seed, static_cast<std::uint64_t>(cell));
  cv::Mat small(size.height / cell + 2, size.width / cell + 2, CV_32F), out;
  for (int y = 0; y < small.rows; ++y)
    for (int x = 0; x < small.cols; ++x)
      small.at<float>(y, x) = random.at(static_cast<std::uint64_t>(y * small.cols + x));
  cv::resize(small, out, {}, cell, cell, cv::INTER_LINEAR);
  return out(cv::Rect({}, size)).clone();
}

double lobed(double angle) { return 1 + 0.15 * std::sin(5 * angle) + 0.08 * std::sin(9 * angle + 1); }

}  // namespace

cv::Mat blot(cv::Size size, std::uint64_t seed) {
  const cv::Mat fine = noise(size, 2, seed), coarse = noise(size, 8, seed + 1);
  cv::Mat out(size, CV_8UC4);
  const double radius = 0.4 * std::min(size.width, size.height);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double dx = x - 0.5 * size.width, dy = y - 0.5 * size.height;
      const double inside = radius * lobed(std::atan2(dy, dx) + 2) - std::hypot(dx, dy);
      const float contrast = x < size.width / 2 ? 0.15f : 1.0f;
      const float value =
          0.5f + contrast * (0.6f * (fine.at<float>(y, x) - 0.5f) + 0.3f * (coarse.at<float>(y, x) - 0.5f));
      const auto byte = [](double v) { return cv::saturate_cast<std::uint8_t>(255 * v); };
      out.at<cv::Vec4b>(y, x) = {byte(0.2 * static_cast<double>(value)), byte(static_cast<double>(value)),
                                 byte(0.4 + 0.6 * static_cast<double>(value)), byte(inside / 4 + 0.5)};
    }
  return out;
}

TargetFrame turning_disc(cv::Size size, int frame, double radians_per_frame) {
  TargetFrame made{cv::Mat(size, CV_32F, cv::Scalar(0)), cv::Mat(size, CV_32FC2, cv::Scalar::all(0))};
  const double radius = 0.36 * std::min(size.width, size.height);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double dx = x - 0.5 * size.width, dy = y - 0.5 * size.height;
      const double angle = std::atan2(dy, dx) - radians_per_frame * frame;
      const double alpha = std::clamp((radius * lobed(angle) - std::hypot(dx, dy)) / 3 + 0.5, 0.0, 1.0);
      made.alpha.at<float>(y, x) = static_cast<float>(alpha);
      if (alpha > 0)
        made.flow.at<cv::Vec2f>(y, x) = {static_cast<float>(-dy * radians_per_frame),
                                         static_cast<float>(dx * radians_per_frame)};
    }
  return made;
}

double laplacian_energy(const cv::Mat& bgra) {
  std::vector<cv::Mat> planes;
  cv::split(bgra, planes);
  cv::Mat green, laplacian, whole;
  planes[1].convertTo(green, CV_32F);
  cv::Laplacian(green, laplacian, CV_32F);
  const double top = bgra.depth() == CV_8U ? 255 : 1;
  cv::erode(planes[3] > 0.95 * top, whole, cv::Mat::ones(3, 3, CV_8U));
  return cv::mean(laplacian.mul(laplacian), whole)[0] / (top * top);
}

}  // namespace freshet::synth::transfer
