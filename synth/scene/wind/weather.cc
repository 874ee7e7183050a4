#include "synth/scene/wind/weather.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace freshet::synth::scene {
namespace {

constexpr double kTurnDeg = 360;
constexpr double kBackFromS = 26, kBackToS = 20;  // before the cycle's end: between them it goes back

/// The angle that is `to` or a whole number of turns away from it, and nearest to `from`.
double short_way(double from, double to) { return to - kTurnDeg * std::ceil((to - from) / kTurnDeg - 0.5); }

/// The curve of one of the wind's values. angle   degrees: the short way round.
MonotoneCurve curve_of(const Wind& wind, const Cycle& cycle, double first,
                       std::optional<double> WindKey::*value, bool angle) {
  std::vector<double> times{0}, values{first};
  const auto add = [&](double time_s, double to) {
    times.push_back(time_s);
    values.push_back(angle ? short_way(values.back(), to) : to);
  };
  for (const WindKey& key : wind.at)
    if (key.*value) add(key.time_s, *(key.*value));
  const double now = values.back(), then = angle ? short_way(now, first) : first;
  const double back_s = cycle.seconds() - kBackFromS;
  if (now != then && back_s > times.back()) {
    add(back_s, now);
    add(cycle.seconds() - kBackToS, first);
  }
  return {std::move(times), std::move(values)};
}

}  // namespace

Weather::Weather(const Wind& wind, const Cycle& cycle)
    : wind_(wind),
      cycle_(cycle),
      speed_(curve_of(wind, cycle, wind.speed_m_per_s, &WindKey::speed_m_per_s, false)),
      direction_(curve_of(wind, cycle, wind.direction_deg, &WindKey::direction_deg, true)),
      gustiness_(curve_of(wind, cycle, wind.gustiness, &WindKey::gustiness, false)),
      strongest_(at(0)),
      calmest_(wind.speed_m_per_s),
      gusts_(wind.gustiness > 0) {
  // Between its keys no value exceeds them.
  for (const WindKey& key : wind.at) {
    const Wind then = at(key.time_s);
    if (then.speed_m_per_s > strongest_.speed_m_per_s) strongest_ = then;
    calmest_ = std::min(calmest_, then.speed_m_per_s);
    gusts_ = gusts_ || then.gustiness > 0;
  }
  if (!changes()) return;
  const int count = kSteps * cycle.frames;
  const double step_s = 1 / (kSteps * cycle.fps);
  double gone = 0;
  for (int i = 0; i <= count; ++i) {
    const Wind now = at(i * step_s);
    const double angle = now.direction_deg * std::numbers::pi / 180;
    if (i > 0) gone += step_s * speed_.at((i - 0.5) * step_s);
    steps_.push_back({now.speed_m_per_s, std::cos(angle), std::sin(angle), now.gustiness, gone});
  }
}

Wind Weather::at(double seconds) const {
  Wind now = wind_;
  now.at.clear();
  now.speed_m_per_s = speed_.at(seconds);
  now.direction_deg = direction_.at(seconds);
  now.gustiness = gustiness_.at(seconds);
  return now;
}

std::vector<double> Weather::knots_s() const {
  constexpr int kBetween = 4, kMost = 48;
  std::vector<double> knots{0};
  if (!changes()) return knots;
  const double last = wind_.at.back().time_s, least = last / kMost;
  for (const WindKey& key : wind_.at) {
    const double from = knots.back(), length = key.time_s - from;
    if (length < least && key.time_s < last) continue;
    const int steps = std::clamp(static_cast<int>(length / least), 1, kBetween);
    for (int i = 1; i <= steps; ++i) knots.push_back(from + length * i / steps);
  }
  return knots;
}

}  // namespace freshet::synth::scene
