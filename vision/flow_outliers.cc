#include "vision/flow_outliers.h"

#include <algorithm>
#include <cstddef>

namespace freshet::vision {
namespace {

constexpr float kStillShare = 0.1f;
constexpr float kFastest = 2.5f;        // times the median
constexpr float kLeastJump_px = 0.25f;  // a clip that hardly moves has no outliers for moving a little
constexpr std::size_t kReach = 2;       // frames

float largest(std::span<const float> speed) { return speed.empty() ? 0 : *std::ranges::max_element(speed); }

bool is_still(std::span<const float> speed, std::size_t i) {
  const std::size_t before = std::min(i, kReach), after = std::min(speed.size() - i - 1, kReach);
  const float left = largest(speed.subspan(i - before, before)), right = largest(speed.subspan(i + 1, after));
  // On one side alone they may be fast ones.
  const float around = before == 0 ? right : after == 0 ? left : std::min(left, right);
  return speed[i] < kStillShare * around;
}

}  // namespace

std::vector<FlowOutlier> flow_outliers(std::span<const float> speed) {
  std::vector<FlowOutlier> outliers(speed.size(), FlowOutlier::kNone);
  std::vector<float> sorted;
  sorted.reserve(speed.size());
  for (std::size_t i = 0; i < speed.size(); ++i) {
    if (is_still(speed, i))
      outliers[i] = FlowOutlier::kStill;
    else
      sorted.push_back(speed[i]);
  }
  if (sorted.empty()) return outliers;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const float most = std::max(kFastest * *middle, *middle + kLeastJump_px);
  for (std::size_t i = 0; i < speed.size(); ++i)
    if (speed[i] > most) outliers[i] = FlowOutlier::kFast;
  return outliers;
}

}  // namespace freshet::vision
