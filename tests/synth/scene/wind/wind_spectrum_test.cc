#include "synth/scene/wind/wind_spectrum.h"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace freshet::synth::scene {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

double value_at(const Harmonics& of, double seconds, double cycle_s) {
  double sum = 0;
  for (std::size_t k = 0; k < of.size(); ++k)
    sum += (of[k] * std::polar(1.0, kTurn * static_cast<double>(k) * seconds / cycle_s)).real();
  return sum;
}

TEST(WindSpectrum, FallsWithTheExponentOfEquation8) {
  const Wind wind{.speed_m_per_s = 5, .kappa_m = 100};
  const double slope = std::log(wind_power(wind, 40) / wind_power(wind, 20)) / std::log(2.0);
  EXPECT_NEAR(slope, -5.0 / 3, 0.01);
  EXPECT_NEAR(wind_power(wind, 0.005) / wind_power(wind, 0), std::pow(1.1, -5.0 / 3), 1e-12);
}

TEST(WindSpectrum, HoldsTheTurbulenceInAll) {
  const Wind wind{.speed_m_per_s = 7, .turbulence = 0.3, .kappa_m = 50};
  double variance = 0;
  // In steps of equal ratio, from where the spectrum is flat to where little is left; the tail goes as f^(-2/3).
  constexpr double kRatio = 1.001, kLast = 1e6;
  double f = 1e-5;
  variance += f * wind_power(wind, 0);
  for (; f < kLast; f *= kRatio) variance += wind_power(wind, f * std::sqrt(kRatio)) * f * (kRatio - 1);
  variance += 1.5 * f * wind_power(wind, f);
  EXPECT_NEAR(std::sqrt(variance), 0.3 * 7, 0.002);
}

TEST(WindSpectrum, RealisationsHaveThePowerAndItsSlope) {
  const Wind wind{.speed_m_per_s = 5, .kappa_m = 100};
  const Cycle cycle{.frames = 512, .fps = 64};
  std::vector<double> power(256, 0);
  constexpr int kTimes = 400;
  for (std::uint64_t stream = 0; stream < kTimes; ++stream) {
    const Harmonics one = wind_harmonics(wind, cycle, stream);
    for (std::size_t k = 1; k < power.size(); ++k)
      power[k] += std::norm(one[k]) / 2 / kTimes * cycle.seconds();
  }
  // Least squares of log power over log frequency, 4 to 31 Hz.
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, ratio = 0;
  for (std::size_t k = 32; k < 250; ++k) {
    const double f = static_cast<double>(k) / cycle.seconds(), x = std::log(f), y = std::log(power[k]);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
    ratio += power[k] / wind_power(wind, f);
  }
  EXPECT_NEAR((n * sxy - sx * sy) / (n * sxx - sx * sx), -5.0 / 3, 0.04);
  EXPECT_NEAR(ratio / n, 1, 0.02);
}

TEST(WindSpectrum, SeriesIsTheSumOfItsHarmonics) {
  const Cycle cycle{.frames = 75, .fps = 25};
  const Harmonics wind = wind_harmonics({}, cycle, 3);
  const std::vector<float> values = series(wind, cycle);
  for (int t = 0; t < cycle.frames; ++t)
    EXPECT_NEAR(values[static_cast<std::size_t>(t)], value_at(wind, t / cycle.fps, cycle.seconds()), 1e-5);
}

TEST(WindSpectrum, DelayedByWholeFramesIsTheSameLater) {
  const Cycle cycle{.frames = 50, .fps = 25};
  const Harmonics wind = wind_harmonics({}, cycle, 4);
  const std::vector<float> now = series(wind, cycle), later = series(delayed(wind, cycle, 7 / 25.0), cycle);
  for (std::size_t t = 0; t < 50; ++t) EXPECT_NEAR(later[(t + 7) % 50], now[t], 1e-5);
}

/// Eq. 4, stepped through time (Runge and Kutta, fourth order) until the state repeats from cycle to cycle.
TEST(WindSpectrum, OscillatorIsEquation4SteppedThroughTime) {
  const Cycle cycle{.frames = 100, .fps = 25};
  for (const double natural : {0.3, 0.5, 2.0}) {
    for (const double damping : {0.6, 3.0}) {
      const Harmonics force = wind_harmonics({}, cycle, 5);
      const std::vector<float> tip = series(oscillator(force, cycle, natural, damping), cycle);
      constexpr int kSteps = 40;  // a frame
      const double step = 1 / (cycle.fps * kSteps);
      // The force at whole and half steps of one cycle.
      std::vector<double> wind;
      for (int i = 0; i < 2 * kSteps * cycle.frames; ++i)
        wind.push_back(value_at(force, 0.5 * i * step, cycle.seconds()));
      const auto change = [&](std::array<double, 2> s, double w) {
        return std::array{s[1], w - damping * s[1] - kTurn * kTurn * natural * natural * s[0]};
      };
      std::array<double, 2> state{0, 0};
      const auto moved = [&](const std::array<double, 2>& by, double h) {
        return std::array{state[0] + h * by[0], state[1] + h * by[1]};
      };
      double error = 0, square = 0;
      const int cycles = static_cast<int>(std::ceil(40 / damping / cycle.seconds())) + 1;
      for (int c = 0; c < cycles; ++c) {
        for (int i = 0; i < kSteps * cycle.frames; ++i) {
          if (c == cycles - 1 && i % kSteps == 0) {
            const double expected = state[0], found = tip[static_cast<std::size_t>(i / kSteps)];
            error += (found - expected) * (found - expected);
            square += expected * expected;
          }
          const std::size_t at = 2 * static_cast<std::size_t>(i);
          const auto a = change(state, wind[at]), b = change(moved(a, step / 2), wind[at + 1]),
                     d = change(moved(b, step / 2), wind[at + 1]),
                     e = change(moved(d, step), wind[(at + 2) % wind.size()]);
          for (std::size_t j = 0; j < 2; ++j) state[j] += step / 6 * (a[j] + 2 * b[j] + 2 * d[j] + e[j]);
        }
      }
      EXPECT_LT(std::sqrt(error / square), 1e-3) << natural << " Hz, " << damping << " / s";
    }
  }
}

}  // namespace
}  // namespace freshet::synth::scene
