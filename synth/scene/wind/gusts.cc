#include "synth/scene/wind/gusts.h"

#include <cmath>
#include <numbers>

namespace freshet::synth::scene {
namespace {

constexpr double kAcross = 0.75, kUpright = 0.5;
constexpr double kStrength[3] = {1, kAcross, kUpright};
constexpr double kSlowHz = 0.6;  // faster turbulence is smaller than what a person sees as one gust

double angle_of(const Wind& wind) { return wind.direction_deg * std::numbers::pi / 180; }

}  // namespace

Gusts::Gusts(const Wind& wind, const Cycle& cycle, int picture_width)
    : wind_(wind), cycle_(cycle), metre_per_px_(wind.width_m / picture_width) {
  for (std::uint64_t axis = 0; axis < 3; ++axis) shared_[axis] = wind_harmonics(wind, cycle, axis);
  Harmonics slow = shared_[0];
  for (std::size_t k = 0; k < slow.size(); ++k) {
    const double f = static_cast<double>(k) / cycle.seconds() / kSlowHz;
    slow[k] *= std::exp(-f * f);
  }
  slow_ = series(slow, cycle);
}

double Gusts::delay_s(double x) const {
  if (!(wind_.speed_m_per_s > 0)) return 0;
  return x * metre_per_px_ * std::cos(angle_of(wind_)) / wind_.speed_m_per_s;
}

Harmonics Gusts::part(int axis, double x, std::uint64_t stream) const {
  const Harmonics own = wind_harmonics(wind_, cycle_, 16 * (stream + 1) + static_cast<std::uint64_t>(axis));
  const double strength = kStrength[axis];
  return mixed(strength * std::sqrt(1 - wind_.gustiness), own, strength * std::sqrt(wind_.gustiness),
               delayed(shared_[axis], cycle_, delay_s(x)));
}

Harmonics Gusts::force(double x, cv::Point2d direction, std::uint64_t stream) const {
  const double angle = angle_of(wind_);
  const Harmonics sideways = mixed(std::cos(angle), part(0, x, stream), -std::sin(angle), part(1, x, stream));
  return mixed(direction.x, sideways, direction.y, part(2, x, stream));
}

Harmonics Gusts::force_towards(double x, std::uint64_t stream) const {
  const double angle = angle_of(wind_);
  return mixed(std::sin(angle), part(0, x, stream), std::cos(angle), part(1, x, stream));
}

float Gusts::strength(double x, int frame) const {
  if (!any()) return 0;
  // Between frames linear; the slow part has nothing finer.
  const double at = static_cast<double>(cycle_.place(frame)) - delay_s(x) * cycle_.fps;
  const double whole = std::floor(at);
  const int before = cycle_.place(static_cast<int>(std::fmod(whole, cycle_.frames)));
  const int after = cycle_.place(before + 1);
  const float part = static_cast<float>(at - whole);
  const float value =
      slow_[static_cast<std::size_t>(before)] * (1 - part) + slow_[static_cast<std::size_t>(after)] * part;
  return value * static_cast<float>(wind_.gustiness / std::max(wind_.speed_m_per_s, 1e-6));
}

}  // namespace freshet::synth::scene
