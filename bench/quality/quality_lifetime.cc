#include "bench/quality/quality_lifetime.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::bench {
namespace {

constexpr double kDetailSigma = 4;  // px
constexpr int kBegins = 6;          // frames between two beginnings of ways
constexpr float kInside = 1;        // px from the picture's edge

cv::Mat detail_of(const cv::Mat& luma) {
  cv::Mat values, blurred;
  luma.convertTo(values, CV_32F);
  cv::GaussianBlur(values, blurred, {}, kDetailSigma);
  return values - blurred;
}

/// Sums of products of what was at the beginning (a) and what is there now (b).
struct Products {
  double ab = 0, aa = 0, bb = 0;
};

/// All ways that begin in frame `first`.
std::array<Products, kLifetimeLags> follow(std::span<const cv::Mat> detail, std::span<const cv::Mat> flow,
                                           const cv::Mat& matte, std::size_t first) {
  std::array<Products, kLifetimeLags> products{};
  cv::Mat place(matte.size(), CV_32FC2), step, now, in_matte;
  for (int y = 0; y < place.rows; ++y)
    for (int x = 0; x < place.cols; ++x)
      place.at<cv::Vec2f>(y, x) = {static_cast<float>(x), static_cast<float>(y)};
  const float right = static_cast<float>(matte.cols - 1) - kInside,
              bottom = static_cast<float>(matte.rows - 1) - kInside;
  for (int lag = 1; lag <= kLifetimeLags; ++lag) {
    cv::remap(flow[first + lag - 1], step, place, cv::noArray(), cv::INTER_LINEAR);
    place += step;
    cv::remap(detail[first + lag], now, place, cv::noArray(), cv::INTER_LINEAR);
    cv::remap(matte, in_matte, place, cv::noArray(), cv::INTER_NEAREST);
    Products& sum = products[lag - 1];
    for (int y = 0; y < place.rows; ++y) {
      const cv::Vec2f* at = place.ptr<cv::Vec2f>(y);
      const std::uint8_t *from = matte.ptr<std::uint8_t>(y), *to = in_matte.ptr<std::uint8_t>(y);
      const float *a = detail[first].ptr<float>(y), *b = now.ptr<float>(y);
      for (int x = 0; x < place.cols; ++x) {
        if (from[x] <= 127 || to[x] <= 127 || at[x][0] <= kInside || at[x][1] <= kInside ||
            at[x][0] >= right || at[x][1] >= bottom)
          continue;
        sum.ab += static_cast<double>(a[x]) * b[x];
        sum.aa += static_cast<double>(a[x]) * a[x];
        sum.bb += static_cast<double>(b[x]) * b[x];
      }
    }
  }
  return products;
}

}  // namespace

LifetimeCurve lifetime_curve(std::span<const cv::Mat> luma, std::span<const cv::Mat> flow,
                             const cv::Mat& matte) {
  LifetimeCurve curve;
  curve.fill(std::numeric_limits<double>::quiet_NaN());
  if (luma.size() < kLifetimeLags + 2) return curve;
  CV_Assert(flow.size() + 1 == luma.size() && luma[0].size() == matte.size());

  const int width = std::min(kLifetimeWidth, matte.cols);
  const double scale = static_cast<double>(width) / matte.cols;
  const cv::Size size(
      width, width == matte.cols ? matte.rows : static_cast<int>(std::lround(matte.rows * scale / 2)) * 2);
  std::vector<cv::Mat> detail(luma.size()), ways(flow.size());
  oneapi::tbb::parallel_for(std::size_t{0}, luma.size(), [&](std::size_t i) {
    cv::Mat reduced;
    cv::resize(luma[i], reduced, size, 0, 0, cv::INTER_AREA);
    detail[i] = detail_of(reduced);
    if (i == flow.size()) return;
    cv::resize(flow[i], reduced, size, 0, 0, cv::INTER_LINEAR);
    ways[i] = reduced * scale;
  });
  cv::Mat inside;
  cv::resize(matte, inside, size, 0, 0, cv::INTER_AREA);

  const std::size_t begins = (luma.size() - kLifetimeLags - 2) / kBegins + 1;
  std::vector<std::array<Products, kLifetimeLags>> sums(begins);
  oneapi::tbb::parallel_for(std::size_t{0}, begins,
                            [&](std::size_t i) { sums[i] = follow(detail, ways, inside, kBegins * i); });
  for (int lag = 0; lag < kLifetimeLags; ++lag) {
    Products all;
    for (const auto& sum : sums) {
      all.ab += sum[lag].ab;
      all.aa += sum[lag].aa;
      all.bb += sum[lag].bb;
    }
    curve[lag] = all.ab / std::max(1e-6, std::sqrt(all.aa * all.bb));
  }
  return curve;
}

double half_life_s(const LifetimeCurve& curve, double fps) {
  if (std::isnan(curve[0])) return curve[0];
  const auto below = std::find_if(curve.begin(), curve.end(), [](double value) { return value < 0.5; });
  const auto lag = below == curve.end() ? kLifetimeLags : below - curve.begin() + 1;
  return static_cast<double>(lag) / fps;
}

double curve_distance(const LifetimeCurve& a, const LifetimeCurve& b) {
  double sum = 0;
  for (int lag = 0; lag < kLifetimeLags; ++lag) sum += std::abs(a[lag] - b[lag]);
  return sum / kLifetimeLags;
}

}  // namespace freshet::bench
