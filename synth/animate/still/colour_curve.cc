#include "synth/animate/still/colour_curve.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "platform/vectors.h"
#include "synth/animate/still/carried_base.h"

namespace freshet::synth::animate {
namespace {

constexpr double kSmooth = 2.5;       // steps
constexpr double kLeastShare = 1e-4;  // of the fluid's pixels: fewer at a luminance tell little

FRESHET_WIDE void follow_row(const std::int16_t* from, const float* to, const float* of_blue,
                             const float* of_red, float most, int n, float* blue, float* red) {
  const float unit = most / CarriedFrame::kOne;
#pragma GCC ivdep
  for (int i = 0; i < n; ++i) {
    const float before = unit * static_cast<float>(from[i]), after = most * to[i];
    const float a0 = before < 0.0f ? 0.0f : before, a = most < a0 ? most : a0;
    const float b0 = after < 0.0f ? 0.0f : after, b = most < b0 ? most : b0;
    const int below_a = static_cast<int>(a), below_b = static_cast<int>(b);
    const float beyond_a = a - static_cast<float>(below_a), beyond_b = b - static_cast<float>(below_b);
    const float blue_a = of_blue[below_a], blue_b = of_blue[below_b], red_a = of_red[below_a],
                red_b = of_red[below_b];
    blue[i] += blue_b + beyond_b * (of_blue[below_b + 1] - blue_b) - blue_a -
               beyond_a * (of_blue[below_a + 1] - blue_a);
    red[i] +=
        red_b + beyond_b * (of_red[below_b + 1] - red_b) - red_a - beyond_a * (of_red[below_a + 1] - red_a);
  }
}

}  // namespace

ColourCurve::ColourCurve(const cv::Mat& bgr, const cv::Mat& luma, const cv::Mat& matte) {
  constexpr int kEnds = kSteps + 1;
  cv::Mat count = cv::Mat::zeros(1, kEnds, CV_64F), sums = cv::Mat::zeros(1, kEnds, CV_64FC2);
  for (int y = 0; y < luma.rows; ++y)
    for (int x = 0; x < luma.cols; ++x) {
      const float weight = matte.at<float>(y, x), l = luma.at<float>(y, x);
      if (weight <= 0) continue;
      const int step = cvRound(std::clamp(l, 0.0f, 1.0f) * kSteps);
      const cv::Vec3f colour = bgr.at<cv::Vec3f>(y, x);
      count.at<double>(step) += weight;
      sums.at<cv::Vec2d>(step) += static_cast<double>(weight) * cv::Vec2d(colour[0] - l, colour[2] - l);
    }
  const double all = cv::sum(count)[0];
  if (all <= 0) return;
  cv::GaussianBlur(count, count, {0, 1}, kSmooth, 0, cv::BORDER_CONSTANT);
  cv::GaussianBlur(sums, sums, {0, 1}, kSmooth, 0, cv::BORDER_CONSTANT);
  std::vector<int> known;
  for (int step = 0; step < kEnds; ++step)
    if (count.at<double>(step) > kLeastShare * all) known.push_back(step);
  for (int step = 0; step < kEnds; ++step) {
    const int nearest = *std::min_element(
        known.begin(), known.end(), [step](int a, int b) { return std::abs(a - step) < std::abs(b - step); });
    for (int k = 0; k < 2; ++k)
      chroma_[k][step] = static_cast<float>(sums.at<cv::Vec2d>(nearest)[k] / count.at<double>(nearest));
  }
  for (auto& channel : chroma_) channel[kEnds] = channel[kSteps];
}

void ColourCurve::follow(const std::int16_t* from, const float* to, int n, float* blue, float* red) const {
  follow_row(from, to, chroma_[0].data(), chroma_[1].data(), kSteps, n, blue, red);
}

}  // namespace freshet::synth::animate
