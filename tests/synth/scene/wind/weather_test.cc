// A wind that changes: its curves, its turbulence and what swings in it, against slow and obvious twins.
#include "synth/scene/wind/weather.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "synth/scene/wind/gaussian.h"
#include "synth/scene/wind/gusts.h"

namespace freshet::synth::scene {
namespace {

constexpr double kWholeTurn = 2 * std::numbers::pi;

/// Bernstein's form of the piece that holds the time, found by a walk.
double slow_curve(const std::vector<double>& times, const std::vector<double>& values, double time) {
  const auto slope = [&](std::size_t i) {
    if (i == 0 || i + 1 == values.size()) return 0.0;
    const double h = times[i] - times[i - 1], l = times[i + 1] - times[i];
    const double a = (values[i] - values[i - 1]) / h, b = (values[i + 1] - values[i]) / l;
    if (a * b <= 0) return 0.0;
    const double share = (1 + l / (h + l)) / 3;
    return a * b / (share * b + (1 - share) * a);
  };
  if (time < times[0]) return values[0];
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    if (time >= times[i + 1]) continue;
    const double length = times[i + 1] - times[i], u = (time - times[i]) / length, v = 1 - u;
    const double b = values[i] + slope(i) * length / 3, c = values[i + 1] - slope(i + 1) * length / 3;
    return v * v * v * values[i] + 3 * v * v * u * b + 3 * v * u * u * c + u * u * u * values[i + 1];
  }
  return values.back();
}

TEST(MonotoneCurve, IsItsSlowTwinAndNeverOvershoots) {
  const std::vector<double> times{0, 1, 1.5, 4, 4.2, 9}, values{3, 3.5, 9, 12, 2, 2};
  const MonotoneCurve curve(times, values);
  double before = curve.at(-1), steepest = 0;
  for (double t = -1; t < 10; t += 0.003) {
    const double now = curve.at(t);
    EXPECT_NEAR(now, slow_curve(times, values, t), 1e-12) << t;
    const bool rises = t<4, falls = t> 4.01;
    EXPECT_TRUE(!rises || now >= before - 1e-12) << t;
    EXPECT_TRUE(!falls || now <= before + 1e-12) << t;
    EXPECT_GE(now, 2);
    EXPECT_LE(now, 12);
    steepest = std::max(steepest, std::abs(now - before));
    before = now;
  }
  EXPECT_LT(steepest, 0.003 * 1.6 * 50);  // no jump: at most some 1.5 times the steepest chord
}

Wind calm_to_storm() {
  return {.speed_m_per_s = 2,
          .direction_deg = 170,
          .gustiness = 0.2,
          .at = {{.time_s = 20, .speed_m_per_s = 2},
                 {.time_s = 30, .speed_m_per_s = 14, .direction_deg = -170, .gustiness = 0.6},
                 {.time_s = 50, .speed_m_per_s = 14},
                 {.time_s = 60, .speed_m_per_s = 2, .direction_deg = 170, .gustiness = 0.2}}};
}
const Cycle kMinute{.frames = 600, .fps = 10};

TEST(Weather, TurnsTheShortWayRoundAndEachValueGoesByItsOwnKeys) {
  const Weather weather(calm_to_storm(), kMinute);
  EXPECT_EQ(weather.at(0).speed_m_per_s, 2);
  EXPECT_EQ(weather.at(20).speed_m_per_s, 2);
  EXPECT_EQ(weather.at(40).speed_m_per_s, 14);
  EXPECT_EQ(weather.at(60).speed_m_per_s, 2);
  EXPECT_GT(weather.at(10).direction_deg, 170);  // no key of direction at 20 s: it is on its way
  for (double t = 0; t <= 60; t += 0.1) {
    EXPECT_GE(weather.at(t).direction_deg, 170);
    EXPECT_LE(weather.at(t).direction_deg, 190);
  }
  EXPECT_EQ(weather.at(30).direction_deg, 190);
  EXPECT_EQ(weather.strongest().speed_m_per_s, 14);
  EXPECT_EQ(weather.calmest_m_per_s(), 2);
  EXPECT_TRUE(weather.gusts());
  EXPECT_FALSE(weather.at(30).changes());
  // What is integrated: by the trapezium over a fine grid.
  double gone = 0;
  for (int i = 0; i < 60000; ++i)
    gone += (weather.at(i / 1000.0).speed_m_per_s + weather.at((i + 1) / 1000.0).speed_m_per_s) / 2000;
  EXPECT_NEAR(weather.steps().back().gone_m, gone, 1e-3);
}

TEST(Weather, HasKnotsBetweenItsKeysButNotTooMany) {
  EXPECT_EQ(Weather({}, kMinute).knots_s(), std::vector<double>{0});
  const std::vector<double> few = Weather(calm_to_storm(), kMinute).knots_s();
  ASSERT_EQ(few.size(), 17u);
  EXPECT_EQ(few[1], 5);
  EXPECT_EQ(few[4], 20);
  EXPECT_EQ(few.back(), 60);
  Wind many;
  for (int i = 1; i <= 256; ++i) many.at.push_back({.time_s = 0.1 * i, .speed_m_per_s = 5.0 + i % 2});
  const std::vector<double> knots = Weather(many, kMinute).knots_s();
  EXPECT_LT(knots.size(), 55u);
  EXPECT_EQ(knots.back(), many.at.back().time_s);
  for (std::size_t i = 1; i < knots.size(); ++i) EXPECT_GT(knots[i], knots[i - 1]);
}

TEST(Weather, OfAFilmThatIsNoLoopGoesBackAfterIt) {
  Scene scene;
  scene.frames = 250, scene.fps = 25;
  scene.wind = {.speed_m_per_s = 1,
                .direction_deg = 0,
                .at = {{.time_s = 10, .speed_m_per_s = 15, .direction_deg = 90}}};
  const Cycle cycle = cycle_of(scene);
  EXPECT_GE(cycle.seconds(), 40);
  const Weather weather(scene.wind, cycle);
  EXPECT_EQ(weather.at(11).speed_m_per_s, 15);
  EXPECT_EQ(weather.at(cycle.seconds()).speed_m_per_s, 1);
  EXPECT_EQ(weather.at(cycle.seconds()).direction_deg, 0);
  scene.wind.at.clear();
  EXPECT_EQ(cycle_of(scene).frames, 1500);  // as it always was
}

/// The turbulence along the wind at a place of its own, by the definition: its harmonics summed at the way that the air
/// has gone.
double slow_passing(const Wind& wind, double length_m, double gone_m, double speed, std::uint64_t stream,
                    int harmonics) {
  const Random random(wind.seed, stream);
  double sum = 0;
  for (int k = 1; k < harmonics; ++k) {
    const double n = k / length_m;
    const double power = wind.kappa_m * 2 / 3 / std::pow(1 + wind.kappa_m * n, 5.0 / 3);
    sum += (complex_gaussian(random, static_cast<std::uint64_t>(k)) * std::sqrt(2 * power / length_m) *
            std::polar(1.0, kWholeTurn * n * gone_m))
               .real();
  }
  return wind.turbulence * speed * sum;
}

TEST(Gusts, UnderAChangingWindAreTheTurbulenceAlongTheWayOfTheAir) {
  Wind wind = calm_to_storm();
  wind.direction_deg = 0, wind.gustiness = 0;
  for (WindKey& key : wind.at) key.direction_deg.reset(), key.gustiness.reset();
  const Cycle cycle{.frames = 150, .fps = 2.5};
  const Gusts gusts(wind, cycle, 200);
  const Weather weather(wind, cycle);
  const double length = weather.steps().back().gone_m;
  const std::vector<float> found = series(gusts.force(0, {1, 0}, 3), cycle);
  double off = 0, all = 0;
  for (int t = 0; t < cycle.frames; ++t) {
    // All that a frame can show: means over it leave out what is faster.
    double mean = 0;
    for (int i = -3; i <= 3; ++i) {
      const int count = Weather::kSteps * cycle.frames;
      const auto& step = weather.steps()[static_cast<std::size_t>((Weather::kSteps * t + i + count) % count)];
      mean += (4 - std::abs(i)) / 16.0 *
              slow_passing(wind, length, step.gone_m, step.speed_m_per_s, 16 * 4, 2 * cycle.frames);
    }
    off += std::pow(found[static_cast<std::size_t>(t)] - mean, 2), all += mean * mean;
  }
  EXPECT_GT(all, 1);
  EXPECT_LT(off, 0.06 * all);
}

TEST(Gusts, UnderAWindWhoseKeysSayWhatItIsAreThoseWithoutKeys) {
  const Wind steady{.speed_m_per_s = 6, .direction_deg = 40, .gustiness = 0.5};
  Wind keyed = steady;
  keyed.at = {{.time_s = 20, .speed_m_per_s = 6, .direction_deg = 40, .gustiness = 0.5}};
  const Gusts plain(steady, kMinute, 300), same(keyed, kMinute, 300);
  const auto swing = [&](const Gusts& gusts, double x) {
    return series(oscillator(gusts.force(x, {0.8, 0.6}, 5), kMinute, 0.5, 0.6), kMinute);
  };
  for (const double x : {0.0, 140.0}) {
    const std::vector<float> a = swing(plain, x), b = swing(same, x);
    const float most = *std::max_element(a.begin(), a.end());
    EXPECT_GT(most, 0.01);
    for (std::size_t t = 0; t < a.size(); ++t) EXPECT_NEAR(a[t], b[t], 0.02 * most) << t;
    for (int frame = 0; frame < 600; frame += 37)
      EXPECT_NEAR(plain.strength(x, frame), same.strength(x, frame), 2e-3);
  }
  for (const auto& value : same.mean_force({1, 0})) EXPECT_LT(std::abs(value), 1e-12);
  EXPECT_TRUE(plain.mean_force({1, 0}).empty());
}

/// Eq. 4 stepped through time under a force at every frame, linear between frames, until its state repeats.
std::vector<double> slow_swing(const std::vector<float>& force, const Cycle& cycle, double natural_hz,
                               double damping_per_s) {
  constexpr int kSteps = 40;
  const double h = 1 / (cycle.fps * kSteps);
  double x = 0, v = 0;
  std::vector<double> out(force.size());
  for (int round = 0; round < 3; ++round)
    for (std::size_t t = 0; t < force.size(); ++t) {
      out[t] = x;
      for (int i = 0; i < kSteps; ++i) {
        const double part = (i + 0.5) / kSteps,
                     w = force[t] + (force[(t + 1) % force.size()] - force[t]) * part;
        const auto pull = [&](double at, double speed) {
          return w - damping_per_s * speed - kWholeTurn * kWholeTurn * natural_hz * natural_hz * at;
        };
        const double middle_v = v + h / 2 * pull(x, v), middle_x = x + h / 2 * v;
        x += h * middle_v, v += h * pull(middle_x, middle_v);
      }
    }
  return out;
}

TEST(Gusts, WhatSwingsInAChangingWindIsEquation4SteppedThroughTime) {
  const Gusts gusts(calm_to_storm(), {.frames = 1500, .fps = 25}, 300);
  const Cycle cycle{.frames = 1500, .fps = 25};
  const Harmonics sway = gusts.force(100, {1, 0}, 2), mean = gusts.mean_force({1, 0});
  for (const Harmonics& force : {sway, mean}) {
    const std::vector<float> tip = series(oscillator(force, cycle, 0.5, 0.6), cycle);
    const std::vector<double> slow = slow_swing(series(force, cycle), cycle, 0.5, 0.6);
    double off = 0, all = 0;
    for (std::size_t t = 0; t < tip.size(); ++t)
      off += std::pow(tip[t] - slow[t], 2), all += slow[t] * slow[t];
    EXPECT_LT(std::sqrt(off / all), 5e-3);
  }
}

/// Eq. 8 at a moment: power of the force over windows of many seeds against the stationary wind of that moment.
TEST(Gusts, HaveTheSpectrumAndTheVarianceOfTheWindOfTheirTime) {
  constexpr int kTimes = 120, kWindow = 400;  // 16 s in the calm, 16 s in the storm
  const Cycle cycle{.frames = 1500, .fps = 25};
  double power[2][2][3] = {}, variance[2][2] = {};  // [changing or stationary][calm, storm][band]
  for (std::uint64_t seed = 1; seed <= kTimes; ++seed) {
    Wind wind = calm_to_storm();
    wind.gustiness = 0, wind.direction_deg = 0, wind.seed = seed;
    for (WindKey& key : wind.at) key.direction_deg.reset(), key.gustiness.reset();
    const std::vector<float> changing = series(Gusts(wind, cycle, 300).force(0, {1, 0}, 1), cycle);
    for (const int when : {0, 1}) {
      Wind steady{.speed_m_per_s = when == 0 ? 2.0 : 14.0, .seed = seed};
      const std::vector<float> same = series(Gusts(steady, cycle, 300).force(0, {1, 0}, 1), cycle);
      for (const int kind : {0, 1}) {
        const std::vector<float>& of = kind == 0 ? changing : same;
        const std::size_t first = when == 0 ? 50 : 800;
        double mean = 0;
        for (std::size_t t = 0; t < kWindow; ++t) mean += of[first + t] / kWindow;
        for (std::size_t t = 0; t < kWindow; ++t)
          variance[kind][when] += std::pow(of[first + t] - mean, 2) / kWindow;
        // Hann's window: what is at its ends is no jump.
        for (int k = 2; k < 64; ++k) {
          std::complex<double> sum = 0;
          for (int t = 0; t < kWindow; ++t)
            sum += (of[first + static_cast<std::size_t>(t)] - mean) *
                   (0.5 - 0.5 * std::cos(kWholeTurn * (t + 0.5) / kWindow)) *
                   std::polar(1.0, -kWholeTurn * k * t / kWindow);
          power[kind][when][k < 6 ? 0 : k < 20 ? 1 : 2] += std::norm(sum);
        }
      }
    }
  }
  for (const int when : {0, 1}) {
    EXPECT_NEAR(variance[0][when] / variance[1][when], 1, 0.2) << when;
    for (int band = 0; band < 3; ++band)
      EXPECT_NEAR(power[0][when][band] / power[1][when][band], 1, 0.25) << when << " " << band;
  }
  EXPECT_GT(variance[0][1], 20 * variance[0][0]);
}

TEST(Gusts, CrossThePictureAtTheSpeedThatTheWindHasThen) {
  const Wind wind{.speed_m_per_s = 4,
                  .gustiness = 1,
                  .width_m = 40,
                  .at = {{.time_s = 25, .speed_m_per_s = 4},
                         {.time_s = 30, .speed_m_per_s = 10},
                         {.time_s = 55, .speed_m_per_s = 10},
                         {.time_s = 60, .speed_m_per_s = 4}}};
  const Cycle cycle{.frames = 1200, .fps = 20};
  const Gusts gusts(wind, cycle, 200);
  for (int frame = 0; frame < 200; frame += 20)
    EXPECT_NEAR(gusts.strength(0, frame), gusts.strength(200, frame + 200), 1e-3);
  for (int frame = 620; frame < 1000; frame += 20)
    EXPECT_NEAR(gusts.strength(0, frame), gusts.strength(200, frame + 80), 1e-3);
}

}  // namespace
}  // namespace freshet::synth::scene
