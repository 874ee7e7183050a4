#include "synth/scene/wind/monotone_curve.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace freshet::synth::scene {

MonotoneCurve::MonotoneCurve(std::vector<double> times, std::vector<double> values)
    : times_(std::move(times)), values_(std::move(values)), slopes_(values_.size(), 0) {
  assert(!values_.empty() && times_.size() == values_.size());
  for (std::size_t i = 1; i + 1 < values_.size(); ++i) {
    const double before = times_[i] - times_[i - 1], after = times_[i + 1] - times_[i];
    const double from = (values_[i] - values_[i - 1]) / before, to = (values_[i + 1] - values_[i]) / after;
    if (!(from * to > 0)) continue;
    const double near_from = 2 * after + before, near_to = after + 2 * before;
    slopes_[i] = (near_from + near_to) / (near_from / from + near_to / to);
  }
}

double MonotoneCurve::at(double time) const {
  if (time <= times_.front()) return values_.front();
  if (time >= times_.back()) return values_.back();
  const auto after = static_cast<std::size_t>(std::ranges::upper_bound(times_, time) - times_.begin());
  const std::size_t before = after - 1;
  const double length = times_[after] - times_[before], u = (time - times_[before]) / length;
  const double rise = values_[after] - values_[before], from = slopes_[before] * length,
               to = slopes_[after] * length;
  return values_[before] + u * (from + u * (3 * rise - 2 * from - to + u * (from + to - 2 * rise)));
}

}  // namespace freshet::synth::scene
