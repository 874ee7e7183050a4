#include "synth/stills/timeline.h"

#include <algorithm>
#include <cmath>

namespace freshet::synth::stills {

Timeline::Timeline(const std::vector<int>& sequence, const Square<double>& rms, const TimingOptions& options)
    : still_(sequence), at_{0.0}, rest_(sequence.size(), 0) {
  const std::size_t n = sequence.size();
  double mean = 0;
  for (std::size_t i = 0; i + 1 < n; ++i) mean += rms(sequence[i], sequence[i + 1]);
  mean = n > 1 ? mean / static_cast<double>(n - 1) : 0;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double share = mean > 0 ? rms(sequence[i], sequence[i + 1]) / mean : 1;
    at_.push_back(at_.back() +
                  options.step_s / options.speed * std::clamp(share, options.shortest, options.longest));
  }
  if (options.exactly_s > 0 && n > 1) {
    const double by = options.exactly_s / at_.back();
    for (double& each : at_) each *= by;
  }
  if (!options.slow_turns) return;
  for (std::size_t i = 1; i + 1 < n; ++i) rest_[i] = sequence[i - 1] == sequence[i + 1];
  if (n > 2 && sequence.front() == sequence.back())
    rest_.front() = rest_.back() = sequence[1] == sequence[n - 2];
}

Instant Timeline::at(double seconds) const {
  if (still_.size() < 2 || seconds >= at_.back()) return {still_.back(), still_.back(), 0};
  const auto after = std::upper_bound(at_.begin(), at_.end(), std::max(0.0, seconds));
  const auto k = static_cast<std::size_t>(after - at_.begin()) - 1;
  const double t = (std::max(0.0, seconds) - at_[k]) / (at_[k + 1] - at_[k]);
  // Hermite's cubic with a slope of 0 where motion turns, and 1 elsewhere.
  const double begins = rest_[k] ? 0 : 1, ends = rest_[k + 1] ? 0 : 1;
  const double t2 = t * t, t3 = t2 * t;
  const double phase = (t3 - 2 * t2 + t) * begins + (-2 * t3 + 3 * t2) + (t3 - t2) * ends;
  return {still_[k], still_[k + 1], std::clamp(phase, 0.0, 1.0)};
}

}  // namespace freshet::synth::stills
