#include "synth/tour/path.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace freshet::synth::tour {
namespace {

std::array<double, 6> numbers_of(const CameraPlace& place) {
  return {place.position[0], place.position[1], place.position[2],
          place.yaw_deg,     place.pitch_deg,   place.view_deg};
}

double slope_between(double before, double after, double step_before, double step_after) {
  if (!(before * after > 0)) return 0;
  const double share = (step_before + 2 * step_after) / (3 * (step_before + step_after));
  return before * after / (share * after + (1 - share) * before);
}

/// One-sided, from two secants, as steep as keeps the curve monotone.
double end_slope(double nearest, double next, double step, double next_step) {
  const double slope = ((2 * step + next_step) * nearest - step * next) / (step + next_step);
  if (slope * nearest <= 0) return 0;
  return std::abs(slope) > 3 * std::abs(nearest) ? 3 * nearest : slope;
}

}  // namespace

Path::Path(std::vector<PathKey> keys, bool eased) : keys_(std::move(keys)) {
  for (const PathKey& key : keys_) values_.push_back(numbers_of(key.place));
  slopes_.resize(values_.size(), {});
  const std::size_t last = keys_.size() - 1;
  const auto step = [&](std::size_t i) { return keys_[i + 1].time_s - keys_[i].time_s; };
  for (int n = 0; n < kNumbers && last > 0; ++n) {
    const auto secant = [&](std::size_t i) { return (values_[i + 1][n] - values_[i][n]) / step(i); };
    for (std::size_t i = 1; i < last; ++i)
      slopes_[i][n] = slope_between(secant(i - 1), secant(i), step(i - 1), step(i));
    if (eased) continue;
    slopes_[0][n] = last == 1 ? secant(0) : end_slope(secant(0), secant(1), step(0), step(1));
    slopes_[last][n] =
        last == 1 ? secant(0) : end_slope(secant(last - 1), secant(last - 2), step(last - 1), step(last - 2));
  }
}

CameraPlace Path::at(double time_s) const {
  if (time_s <= keys_.front().time_s) return keys_.front().place;
  if (time_s >= keys_.back().time_s) return keys_.back().place;
  const auto after = std::ranges::upper_bound(keys_, time_s, {}, &PathKey::time_s);
  const auto i = static_cast<std::size_t>(after - keys_.begin()) - 1;
  const double step = keys_[i + 1].time_s - keys_[i].time_s, t = (time_s - keys_[i].time_s) / step;
  const double t2 = t * t, t3 = t2 * t;
  std::array<double, kNumbers> v{};
  for (int n = 0; n < kNumbers; ++n)
    v[n] = (2 * t3 - 3 * t2 + 1) * values_[i][n] + (t3 - 2 * t2 + t) * step * slopes_[i][n] +
           (3 * t2 - 2 * t3) * values_[i + 1][n] + (t3 - t2) * step * slopes_[i + 1][n];
  return {.position = {v[0], v[1], v[2]}, .yaw_deg = v[3], .pitch_deg = v[4], .view_deg = v[5]};
}

Path made_path(Move move, double amount, double seconds, const Reach& reach, bool eased) {
  constexpr double kPan_deg = 5, kAside = 0.25, kRise = 0.6;
  constexpr int kOrbitKeys = 24;
  CameraPlace from, to;
  switch (move) {
    case Move::kIn:
      to.position[2] = amount * reach.ahead;
      break;
    case Move::kPan:
      from.yaw_deg = -kPan_deg * amount, to.yaw_deg = kPan_deg * amount;
      break;
    case Move::kTruck:
      from.position[0] = -kAside * amount * reach.aside, to.position[0] = kAside * amount * reach.aside;
      break;
    case Move::kRise:
      to.position[1] = kRise * amount;
      break;
    case Move::kOrbit: {
      std::vector<PathKey> keys;
      for (int i = 0; i <= kOrbitKeys; ++i) {
        const double turn = 2 * CV_PI * i / kOrbitKeys;
        CameraPlace place;
        place.position = {kAside * amount * reach.aside * std::sin(turn), 0.1 * amount * (1 - std::cos(turn)),
                          0};
        place.yaw_deg = -std::atan2(place.position[0], reach.pivot) * 180 / CV_PI;
        keys.push_back({seconds * i / kOrbitKeys, place});
      }
      return Path(keys, false);
    }
  }
  return Path({{0, from}, {seconds, to}}, eased);
}

}  // namespace freshet::synth::tour
