#include "synth/scene/rendering/calm_water.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>

namespace freshet::synth::scene {
namespace {

constexpr float kReach = 3;       // deviations
constexpr float kLeastPx = 0.3f;  // of deviation: a pixel smooths no finer

}  // namespace

cv::Mat calmed(const cv::Mat& colour, const cv::Mat& alpha, const Line& horizon, double calm) {
  cv::Mat out = colour.clone();
  if (calm <= 0) return out;
  const cv::Point2d way = horizon.to - horizon.from;
  oneapi::tbb::parallel_for(0, out.rows, [&](int y) {
    for (int x = 0; x < out.cols; ++x) {
      if (alpha.at<float>(y, x) <= 0) continue;
      const double level = horizon.from.y + way.y / way.x * (x + 0.5 - horizon.from.x);
      const auto sigma = static_cast<float>(calm * (y + 0.5 - level));
      if (sigma < kLeastPx) continue;
      const int reach = static_cast<int>(kReach * sigma);
      cv::Vec3f sum(0, 0, 0);
      float mass = 0;
      for (int row = std::max(0, y - reach); row <= std::min(out.rows - 1, y + reach); ++row) {
        const float away = static_cast<float>(row - y) / sigma;
        const float weight = alpha.at<float>(row, x) * std::exp(-0.5f * away * away);
        sum += weight * colour.at<cv::Vec3f>(row, x);
        mass += weight;
      }
      out.at<cv::Vec3f>(y, x) = sum / mass;
    }
  });
  return out;
}

}  // namespace freshet::synth::scene
