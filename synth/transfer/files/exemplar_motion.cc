#include "synth/transfer/files/exemplar_motion.h"

#include <algorithm>
#include <cstdint>

#include <opencv2/imgproc.hpp>

#include "vision/flow.h"

namespace freshet::synth::transfer {
namespace {

/// White's value, of BGRA of 8 or 16 bits or floats.
double full_value(const cv::Mat& bgra) {
  return bgra.depth() == CV_16U ? 65535 : bgra.depth() == CV_8U ? 255 : 1;
}

/// Whether what is seen is dark, and has an alpha: over white its outline shows.
bool is_dark_paint(const cv::Mat& bgra) {
  cv::Mat alpha, grey;
  cv::extractChannel(bgra, alpha, 3);
  const cv::Scalar seen = cv::mean(alpha);
  if (seen[0] == 0 || seen[0] == full_value(bgra)) return false;
  cv::cvtColor(bgra, grey, cv::COLOR_BGRA2GRAY);
  cv::multiply(grey, alpha, grey, 1 / full_value(bgra));
  constexpr double kDark = 0.25;
  return cv::mean(grey)[0] < kDark * seen[0];
}

cv::Mat luma_over(const cv::Mat& bgra, bool over_white) {
  constexpr int kLeast = 16;
  const double white = full_value(bgra);
  const float unit = static_cast<float>(255 / white), to_alpha = static_cast<float>(1 / white);
  cv::Mat wide, luma(bgra.size(), CV_8U);
  bgra.convertTo(wide, CV_32F);
  for (int y = 0; y < luma.rows; ++y) {
    const auto* from = wide.ptr<cv::Vec4f>(y);
    auto* to = luma.ptr<std::uint8_t>(y);
    for (int x = 0; x < luma.cols; ++x) {
      const float grey = unit * (0.114f * from[x][0] + 0.587f * from[x][1] + 0.299f * from[x][2]);
      const float alpha = to_alpha * from[x][3];
      to[x] = cv::saturate_cast<std::uint8_t>(grey * alpha + (over_white ? 255 * (1 - alpha) : 0.0f));
    }
  }
  cv::copyMakeBorder(luma, luma, 0, std::max(0, kLeast - luma.rows), 0, std::max(0, kLeast - luma.cols),
                     cv::BORDER_REPLICATE);
  return luma;
}

}  // namespace

std::array<cv::Mat, 2> seen_by_flow(const cv::Mat& from, const cv::Mat& to, bool is_light) {
  const bool over_white = !is_light && is_dark_paint(from);
  return {luma_over(from, over_white), luma_over(to, over_white)};
}

cv::Mat motion_between(const cv::Mat& from, const cv::Mat& to, bool is_light) {
  const std::array<cv::Mat, 2> seen = seen_by_flow(from, to, is_light);
  return vision::optical_flow(seen[0], seen[1],
                              {.method = vision::FlowMethod::kTvL1})(cv::Rect({0, 0}, from.size()))
      .clone();
}

}  // namespace freshet::synth::transfer
