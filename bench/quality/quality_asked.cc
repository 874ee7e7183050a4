#include "bench/quality/quality_asked.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "bench/quality/quality_measures.h"

namespace freshet::bench {
namespace {

constexpr double kDetailSigma = 4;     // px
constexpr double kNoDetail = 1e-3;     // grey levels, root mean square: the rounding of a flat picture
constexpr double kGoesBack = 0.25;     // px/s: a tenth of the speed that has a direction
constexpr std::size_t kPhases = 8;     // of a loop
constexpr float kAskedLength = 0.25f;  // of a block's mean direction; below it the block is asked nothing

}  // namespace

double detail_correlation(const cv::Mat& frame, const cv::Mat& still, const cv::Mat& matte) {
  const auto detail_of = [](const cv::Mat& luma) {
    cv::Mat values, blurred;
    luma.convertTo(values, CV_32F);
    cv::GaussianBlur(values, blurred, {}, kDetailSigma);
    return cv::Mat(values - blurred);
  };
  cv::Mat a = detail_of(frame), b = detail_of(still);
  const cv::Mat outside = matte <= 127;
  a.setTo(0, outside);
  b.setTo(0, outside);
  const double own = cv::norm(a), stills = cv::norm(b);
  const double least = kNoDetail * std::sqrt(static_cast<double>(matte.total()));
  return own > least && stills > least ? a.dot(b) / (own * stills) : 0;
}

Reversals reversals(std::span<const cv::Mat> motion, const cv::Mat& asked, const cv::Mat& matte) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (motion.empty() || asked.empty()) return {kNone, kNone};
  cv::Mat way, inside;
  cv::resize(asked, way, motion[0].size(), 0, 0, cv::INTER_AREA);
  cv::resize(matte > 127, inside, motion[0].size(), 0, 0, cv::INTER_AREA);
  double back_seconds = 0;
  int back = 0, moving = 0, blocks = 0;
  for (const cv::Mat& second : motion) {
    double along = 0;
    blocks = 0;
    for (int y = 0; y < second.rows; ++y) {
      for (int x = 0; x < second.cols; ++x) {
        const cv::Vec2f to = way.at<cv::Vec2f>(y, x), gone = second.at<cv::Vec2f>(y, x);
        const double length = cv::norm(to);
        if (inside.at<std::uint8_t>(y, x) <= 127 || length < kAskedLength) continue;
        ++blocks;
        along += gone.dot(to) / length;
        if (cv::norm(gone) < kMinSpeed) continue;
        ++moving;
        back += gone.dot(to) < 0 ? 1 : 0;
      }
    }
    if (along < -kGoesBack * blocks) back_seconds += 1;
  }
  if (blocks == 0) return {kNone, kNone};
  return {back_seconds, moving > 0 ? static_cast<double>(back) / moving : 0};
}

double motion_after_loop(std::span<const cv::Mat> luma, int period, const cv::Mat& matte) {
  CV_Assert(period >= 2 && luma.size() >= static_cast<std::size_t>(period));
  const std::size_t phases = std::min(kPhases, static_cast<std::size_t>(period));
  std::vector<cv::Mat> now(phases), later(phases);
  for (std::size_t i = 0; i < phases; ++i) {
    const std::size_t at = i * period / phases, after = at + period;
    luma[at].convertTo(now[i], CV_32F);
    luma[after < luma.size() ? after : after - period].convertTo(later[i], CV_32F);
  }
  const cv::Mat mask = matte > 127;
  std::vector<double> same(phases), other(phases);
  oneapi::tbb::parallel_for(std::size_t{0}, phases, [&](std::size_t i) {
    same[i] = cv::mean(ssim_map(now[i], later[i]), mask)[0];
    for (std::size_t j = 0; j < phases; ++j)
      if (j != i) other[i] += cv::mean(ssim_map(now[i], now[j]), mask)[0] / static_cast<double>(phases - 1);
  });
  double returned = 0;
  for (std::size_t i = 0; i < phases; ++i) returned += (same[i] - other[i]) / static_cast<double>(phases);
  return returned;
}

}  // namespace freshet::bench
