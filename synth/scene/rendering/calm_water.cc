#include "synth/scene/rendering/calm_water.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <vector>

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
    float of = 0;  // the deviation that the weights are of: all of a row's, where the horizon is level
    std::vector<float> weights;  // by distance
    for (int x = 0; x < out.cols; ++x) {
      if (alpha.at<float>(y, x) <= 0) continue;
      const double level = horizon.from.y + way.y / way.x * (x + 0.5 - horizon.from.x);
      const auto sigma = static_cast<float>(calm * (y + 0.5 - level));
      if (sigma < kLeastPx) continue;
      const int reach = static_cast<int>(kReach * sigma);
      if (sigma != of) {
        weights.resize(static_cast<std::size_t>(reach) + 1);
        for (int away = 0; away <= reach; ++away)
          weights[away] = std::exp(-0.5f * static_cast<float>(away * away) / (sigma * sigma));
        of = sigma;
      }
      cv::Vec3f sum(0, 0, 0);
      float mass = 0;
      for (int row = std::max(0, y - reach); row <= std::min(out.rows - 1, y + reach); ++row) {
        const float weight = alpha.at<float>(row, x) * weights[static_cast<std::size_t>(std::abs(row - y))];
        sum += weight * colour.at<cv::Vec3f>(row, x);
        mass += weight;
      }
      out.at<cv::Vec3f>(y, x) = sum / mass;
    }
  });
  return out;
}

}  // namespace freshet::synth::scene
