#include "synth/scene/wind/gusts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "synth/scene/wind/gaussian.h"

namespace freshet::synth::scene {
namespace {

constexpr double kAcross = 0.75, kUpright = 0.5;
constexpr double kStrength[3] = {1, kAcross, kUpright};
constexpr double kSlowHz = 0.6;  // faster turbulence is smaller than what a person sees as one gust

double angle_of(const Wind& wind) { return wind.direction_deg * std::numbers::pi / 180; }

/// A pattern's value at a share of its length, which it repeats; cubic between its samples, whose number is a power
/// of 2.
double passed(const std::vector<double>& pattern, double share) {
  const double at = (share - std::floor(share)) * static_cast<double>(pattern.size()), whole = std::floor(at),
               u = at - whole;
  const auto i = static_cast<std::size_t>(whole), mask = pattern.size() - 1;
  const double a = pattern[(i - 1) & mask], b = pattern[i & mask], c = pattern[(i + 1) & mask],
               d = pattern[(i + 2) & mask];
  return b + 0.5 * u * (c - a + u * (2 * a - 5 * b + 4 * c - d + u * (3 * (b - c) + d - a)));
}

/// Values at kSteps a frame, as harmonics up to half the frame rate, with their mean.
Harmonics harmonics_of(const std::vector<double>& values, const Cycle& cycle) {
  cv::Mat spectrum;
  cv::dft(cv::Mat(1, static_cast<int>(values.size()), CV_64F, const_cast<double*>(values.data())), spectrum,
          cv::DFT_COMPLEX_OUTPUT | cv::DFT_SCALE);
  Harmonics harmonics(static_cast<std::size_t>((cycle.frames - 1) / 2 + 1));
  for (std::size_t k = 0; k < harmonics.size(); ++k) {
    const auto& value = spectrum.at<cv::Vec2d>(static_cast<int>(k));
    harmonics[k] = std::complex<double>(value[0], value[1]) * (k == 0 ? 1.0 : 2.0);
  }
  return harmonics;
}

}  // namespace

double force_strength(const Wind& wind, cv::Point2d direction) {
  const double sideways = std::hypot(std::cos(angle_of(wind)), kAcross * std::sin(angle_of(wind)));
  return std::hypot(direction.x * sideways, direction.y * kUpright);
}

Gusts::Gusts(const Wind& wind, const Cycle& cycle, int picture_width)
    : Gusts(wind, cycle, wind.width_m / picture_width) {}

Gusts::Gusts(const Wind& wind, const Cycle& cycle, double metre_per_px)
    : wind_(wind), cycle_(cycle), weather_(wind, cycle), metre_per_px_(metre_per_px) {
  if (weather_.changes()) {
    for (std::uint64_t axis = 0; axis < 3; ++axis) shared_pattern_[axis] = pattern(axis, false);
    slow_pattern_ = pattern(0, true);
    return;
  }
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

std::vector<double> Gusts::pattern(std::uint64_t stream, bool slow) const {
  // Where the air goes slowly its turbulence of so many hertz is short: it has up to four times as many harmonics as
  // frames, half of what its samples could hold.
  const std::size_t count = std::bit_ceil(static_cast<std::size_t>(8 * cycle_.frames));
  std::vector<double> samples(count, 0);
  const double length_m = weather_.steps().back().gone_m;
  if (!(length_m > 0)) return samples;
  // Eq. 8 by the wave number n = f / v: kappa / (1 + kappa n)^(5/3).
  const Random random(wind_.seed, stream);
  cv::Mat spectrum(1, static_cast<int>(count), CV_64FC2, cv::Scalar::all(0)), values;
  for (std::size_t k = 1; k < count / 4; ++k) {
    const double n = static_cast<double>(k) / length_m;
    const double power = wind_.kappa_m * 2 / 3 / std::pow(1 + wind_.kappa_m * n, 5.0 / 3);
    std::complex<double> value = complex_gaussian(random, k) * std::sqrt(2 * power / length_m);
    const double f = static_cast<double>(k) / cycle_.seconds() / kSlowHz;  // at the mean speed
    if (slow) value *= std::exp(-f * f);
    spectrum.at<cv::Vec2d>(static_cast<int>(k)) = {value.real(), value.imag()};
  }
  cv::dft(spectrum, values, cv::DFT_INVERSE);
  for (std::size_t i = 0; i < count; ++i) samples[i] = values.at<cv::Vec2d>(static_cast<int>(i))[0];
  return samples;
}

std::vector<double> Gusts::passing(int axis, double x, std::uint64_t stream) const {
  const std::vector<double> own = pattern(16 * (stream + 1) + static_cast<std::uint64_t>(axis), false);
  const std::vector<Weather::Step>& steps = weather_.steps();
  const double length_m = steps.back().gone_m, strength = kStrength[axis] * wind_.turbulence;
  std::vector<double> values(steps.size() - 1, 0);
  if (!(length_m > 0)) return values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Weather::Step& now = steps[i];
    double sum = std::sqrt(1 - now.gustiness) * passed(own, now.gone_m / length_m);
    if (now.gustiness > 0)
      sum += std::sqrt(now.gustiness) *
             passed(shared_pattern_[axis], (now.gone_m - x * metre_per_px_ * now.cosine) / length_m);
    values[i] = strength * now.speed_m_per_s * sum;
  }
  return values;
}

Harmonics Gusts::mean_force(cv::Point2d direction) const {
  const std::vector<Weather::Step>& steps = weather_.steps();
  if (steps.empty()) return {};
  std::vector<double> values(steps.size() - 1);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] =
        direction.x * (steps[i].speed_m_per_s * steps[i].cosine - steps[0].speed_m_per_s * steps[0].cosine);
  return harmonics_of(values, cycle_);
}

Harmonics Gusts::mean_force_towards() const {
  const std::vector<Weather::Step>& steps = weather_.steps();
  if (steps.empty()) return {};
  std::vector<double> values(steps.size() - 1);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = steps[i].speed_m_per_s * steps[i].sine - steps[0].speed_m_per_s * steps[0].sine;
  return harmonics_of(values, cycle_);
}

Harmonics Gusts::force(double x, cv::Point2d direction, std::uint64_t stream) const {
  if (weather_.changes()) {
    std::vector<double> values = passing(0, x, stream);
    const std::vector<double> across = passing(1, x, stream), upright = passing(2, x, stream);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Weather::Step& now = weather_.steps()[i];
      values[i] = direction.x * (now.cosine * values[i] - now.sine * across[i]) + direction.y * upright[i];
    }
    return harmonics_of(values, cycle_);
  }
  const double angle = angle_of(wind_);
  const Harmonics sideways = mixed(std::cos(angle), part(0, x, stream), -std::sin(angle), part(1, x, stream));
  return mixed(direction.x, sideways, direction.y, part(2, x, stream));
}

Harmonics Gusts::force_towards(double x, std::uint64_t stream) const {
  if (weather_.changes()) {
    std::vector<double> values = passing(0, x, stream);
    const std::vector<double> across = passing(1, x, stream);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Weather::Step& now = weather_.steps()[i];
      values[i] = now.sine * values[i] + now.cosine * across[i];
    }
    return harmonics_of(values, cycle_);
  }
  const double angle = angle_of(wind_);
  return mixed(std::sin(angle), part(0, x, stream), std::cos(angle), part(1, x, stream));
}

float Gusts::strength(double x, int frame) const {
  if (!any()) return 0;
  if (weather_.changes()) {
    const std::vector<Weather::Step>& steps = weather_.steps();
    const double length_m = steps.back().gone_m;
    const Weather::Step& now = steps[static_cast<std::size_t>(Weather::kSteps * cycle_.place(frame))];
    if (!(length_m > 0)) return 0;
    const double share = (now.gone_m - x * metre_per_px_ * now.cosine) / length_m;
    return static_cast<float>(wind_.turbulence * now.gustiness * passed(slow_pattern_, share));
  }
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
