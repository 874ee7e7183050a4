#include "synth/transfer/files/fine_drawing.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "synth/transfer/motion_blur.h"
#include "synth/transfer/pixel_grid.h"

namespace freshet::synth::transfer {
namespace {

constexpr double kPen = 0.7;     // px: what is finer is not drawn
constexpr float kFaint = 0.03f;  // of alpha: keeps the quotient of two faint values from speaking
constexpr float kMost = 2.5f;
constexpr float kThrough = 0.6f;  // of light that is seen in a gap, from what burns behind it
constexpr float kThin = 0.3f,
                kThick = 0.7f;  // change of the blurred mask nearby: all its drawing is lost, and none

cv::Mat view(Grid& grid) { return {grid.height, grid.width, CV_32F, grid.values.data()}; }

/// 0 to 1: 1 where the blurred mask changes little.
Grid lost(Grid& coarse, double radius) {
  const int reach = static_cast<int>(std::lround(radius));
  const cv::Mat square = cv::Mat::ones(2 * reach + 1, 2 * reach + 1, CV_8U);
  cv::Mat most, least;
  cv::dilate(view(coarse), most, square);
  cv::erode(view(coarse), least, square);
  Grid lost(coarse.width, coarse.height);
  for_rows(lost.height, [&](int y) {
    for (int x = 0; x < lost.width; ++x) {
      const float change = most.at<float>(y, x) - least.at<float>(y, x);
      lost(x, y) = 1 - std::clamp((change - kThin) / (kThick - kThin), 0.0f, 1.0f);
    }
  });
  return blurred(lost, radius);
}

Grid smeared(const Grid& factor, const cv::Mat& flow, double length) {
  PixelGrid one(factor.width, factor.height);
  VectorGrid by(factor.width, factor.height);
  for (std::size_t i = 0; i < factor.values.size(); ++i) {
    const auto at = flow.at<cv::Vec2f>(static_cast<int>(i));
    one.values[i].c[0] = factor.values[i];
    by.values[i] = {at[0], at[1]};
  }
  Grid out(factor.width, factor.height);
  one = blurred_along(one, by, length);
  for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] = one.values[i].c[0];
  return out;
}

}  // namespace

cv::Mat fine_drawing(const TargetFrame& target, const TransferOptions& options) {
  const Grid mask = grid_of(target.alpha), fine = blurred(mask, kPen);
  Grid coarse = blurred(mask, options.radius);
  Grid factor = lost(coarse, options.radius);
  for (std::size_t i = 0; i < factor.values.size(); ++i) {
    const float part = (fine.values[i] + kFaint) / (coarse.values[i] + kFaint);
    const float least = kThrough * coarse.values[i];
    factor.values[i] = 1 + factor.values[i] * (std::clamp(part, least, kMost) - 1);
  }
  if (options.motion_blur > 0) factor = smeared(factor, target.flow, options.motion_blur);
  return view(factor).clone();
}

void draw_light(const cv::Mat& drawing, cv::Mat& light) {
  for_rows(light.rows, [&](int y) {
    const auto* by = drawing.ptr<float>(y);
    auto* at = light.ptr<cv::Vec4f>(y);
    for (int x = 0; x < light.cols; ++x) at[x][3] = std::min(1.0f, at[x][3] * by[x]);
  });
}

}  // namespace freshet::synth::transfer
