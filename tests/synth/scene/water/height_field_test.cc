#include "synth/scene/water/height_field.h"

#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "synth/scene/water/reduced_tile.h"

namespace freshet::synth::scene {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
const Cycle kCycle{.frames = 64, .fps = 16};

WaterMotion small_water() {
  return {.tile = 32, .tile_m = 40, .roughness = 4, .amplitude = 1, .against = 0.3};
}

/// The field's transform over space and time: [frame's harmonic](column, row), of one tile.
std::vector<cv::Mat> transformed(HeightField& field, int plane) {
  const int n = field.samples();
  std::vector<cv::Mat> space;
  for (int t = 0; t < kCycle.frames; ++t) {
    field.go_to(t);
    cv::Mat spectrum;
    cv::dft(field.plane(plane), spectrum, cv::DFT_COMPLEX_OUTPUT | cv::DFT_SCALE);
    space.push_back(spectrum.clone());
  }
  std::vector<cv::Mat> both(static_cast<std::size_t>(kCycle.frames), cv::Mat());
  for (int m = 0; m < kCycle.frames; ++m) {
    cv::Mat& sum = both[static_cast<std::size_t>(m)];
    sum = cv::Mat(n, n, CV_64FC2, cv::Scalar::all(0));
    for (int t = 0; t < kCycle.frames; ++t) {
      const std::complex<double> turn = std::polar(1.0 / kCycle.frames, -kTurn * m * t / kCycle.frames);
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
          const cv::Vec2f v = space[static_cast<std::size_t>(t)].at<cv::Vec2f>(y, x);
          const std::complex<double> turned = std::complex<double>(v[0], v[1]) * turn;
          sum.at<cv::Vec2d>(y, x) += cv::Vec2d(turned.real(), turned.imag());
        }
    }
  }
  return both;
}

TEST(HeightField, WavesGoAsFastAsTheDispersionSays) {
  HeightField field(small_water(), {}, kCycle, 9);
  for (const int plane : {0, 1}) {
    const std::vector<cv::Mat> spectrum = transformed(field, plane);
    const int n = field.samples();
    int waves = 0;
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        const double kx = kTurn * (x <= n / 2 ? x : x - n) / field.side_m(plane),
                     ky = kTurn * (y <= n / 2 ? y : y - n) / field.side_m(plane);
        double all = 0, strongest = 0;
        int at = 0;
        for (int m = 0; m < kCycle.frames; ++m) {
          const cv::Vec2d v = spectrum[static_cast<std::size_t>(m)].at<cv::Vec2d>(y, x);
          const double power = v.dot(v);
          all += power;
          if (power > strongest) strongest = power, at = m;
        }
        const double omega = std::sqrt(9.81 * std::hypot(kx, ky));
        if (omega > kTurn * 7 || all < 1e-12) continue;  // above half the frame rate, or no wave
        ++waves;
        const int harmonic = std::min(at, kCycle.frames - at);
        const double found = kTurn * harmonic / kCycle.seconds();
        EXPECT_NEAR(found, omega, kTurn / kCycle.seconds() / 2 + 1e-6) << kx << " " << ky;
        // All the rest of it goes the other way at the same pace.
        const cv::Vec2d other =
            spectrum[static_cast<std::size_t>((kCycle.frames - at) % kCycle.frames)].at<cv::Vec2d>(y, x);
        EXPECT_NEAR((strongest + other.dot(other)) / all, 1, 1e-4);
      }
    }
    EXPECT_GT(waves, 200);
  }
}

TEST(HeightField, WithNoneAgainstTheWindAllWavesGoWithIt) {
  WaterMotion water = small_water();
  water.against = 0;
  const Wind wind{.direction_deg = 0};
  HeightField field(water, wind, kCycle, 2);
  const std::vector<cv::Mat> spectrum = transformed(field, 0);
  double with = 0, against = 0;
  for (int m = 1; m < kCycle.frames / 2; ++m)
    for (int x = 1; x < field.samples() / 2; ++x) {
      // exp(i (k x + w t)) with both above 0 goes to the left.
      const cv::Vec2d v = spectrum[static_cast<std::size_t>(m)].at<cv::Vec2d>(0, x),
                      u = spectrum[static_cast<std::size_t>(kCycle.frames - m)].at<cv::Vec2d>(0, x);
      against += v.dot(v), with += u.dot(u);
    }
  EXPECT_GT(with, 0);
  EXPECT_LT(against, 1e-6 * with);
}

TEST(HeightField, IsAsHighAsItSays) {
  double variance = 0;
  constexpr int kTimes = 60;
  double expected = 0;
  for (std::uint64_t seed = 0; seed < kTimes; ++seed) {
    HeightField field(small_water(), {}, kCycle, seed);
    expected = field.deviation_m() * field.deviation_m();
    field.go_to(5);
    for (const int plane : {0, 1})
      variance += field.plane(plane).dot(field.plane(plane)) / field.plane(plane).total() / kTimes;
  }
  EXPECT_NEAR(variance / expected, 1, 0.15);
}

TEST(HeightField, SlopesAreTheHeightsDerivatives) {
  const WaterMotion water = small_water();
  HeightField heights(water, {}, kCycle, 3), slopes(water, {}, kCycle, 3, HeightField::What::kSlopes);
  heights.go_to(7), slopes.go_to(7);
  for (int tile = 0; tile < 2; ++tile) {
    // Exactly, by the transform.
    const int n = heights.samples();
    cv::Mat spectrum;
    cv::dft(heights.plane(tile), spectrum, cv::DFT_COMPLEX_OUTPUT | cv::DFT_SCALE);
    for (const bool away : {false, true}) {
      cv::Mat turned = spectrum.clone();
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
          const int i = away ? y : x;
          const auto k = static_cast<float>(kTurn * (i <= n / 2 ? i : i - n) / heights.side_m(tile));
          auto& v = turned.at<cv::Vec2f>(y, x);
          v = {-k * v[1], k * v[0]};
        }
      cv::Mat expected;
      cv::dft(turned, expected, cv::DFT_INVERSE | cv::DFT_REAL_OUTPUT);
      EXPECT_LT(cv::norm(expected, slopes.plane(2 * tile + (away ? 1 : 0)), cv::NORM_INF),
                1e-4 * cv::norm(expected, cv::NORM_INF));
    }
  }
}

TEST(HeightField, RepeatsToTheBitAndForAnyNumberOfThreads) {
  HeightField field(small_water(), {}, kCycle, 1);
  field.go_to(0);
  const cv::Mat first = field.plane(1).clone();
  field.go_to(13);
  const cv::Mat other = field.plane(1).clone();
  EXPECT_GT(cv::norm(first, other, cv::NORM_INF), 0);
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  field.go_to(kCycle.frames);
  EXPECT_EQ(cv::norm(first, field.plane(1), cv::NORM_INF), 0);
  field.go_to(13 - kCycle.frames);
  EXPECT_EQ(cv::norm(other, field.plane(1), cv::NORM_INF), 0);
}

TEST(HeightField, WithoutWindThereIsNoWave) {
  HeightField field(small_water(), {.speed_m_per_s = 0}, kCycle, 1);
  field.go_to(3);
  EXPECT_EQ(cv::norm(field.plane(0), cv::NORM_INF), 0);
}

/// A tile that is one wave, `across` times over its width and `down` times over its height.
cv::Mat one_wave(int n, int across, int down) {
  cv::Mat tile(n, n, CV_32F);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      tile.at<float>(y, x) = static_cast<float>(std::cos(kTurn * (across * x + down * y) / n));
  return tile;
}

double strength_of(int across, int down, double covers_x, double covers_y) {
  constexpr int kN = 64;
  ReducedTile tile(kN);
  need_row(tile, covers_x, covers_y);
  const cv::Mat wave = one_wave(kN, across, down);
  tile.set(wave);
  std::vector<float> row(kN), scratch(2 * kN);
  double most = 0;
  for (double y = 0; y < kN; y += 1.7) {
    sample_row(tile, y, covers_x, covers_y, kN, row.data(), scratch.data());
    for (const float v : row) most = std::max<double>(most, std::abs(v));
  }
  return most;
}

TEST(ReducedTile, KeepsWhatIsLongAndLosesWhatAPixelCovers) {
  EXPECT_GT(strength_of(2, 0, 0.5, 0.5), 0.97);
  EXPECT_GT(strength_of(0, 2, 0.5, 0.5), 0.97);
  // A pixel covers a whole wave.
  EXPECT_LT(strength_of(8, 0, 8, 8), 0.02);
  EXPECT_LT(strength_of(0, 8, 8, 8), 0.02);
  // It covers much water away from the viewer, and little to the side.
  EXPECT_GT(strength_of(8, 0, 0.5, 8), 0.9);
  EXPECT_LT(strength_of(0, 8, 0.5, 8), 0.02);
}

TEST(ReducedTile, GivesTheTileItselfWhereAPixelIsMuchSmallerThanASample) {
  constexpr int kN = 32;
  ReducedTile tile(kN);
  need_row(tile, 0.1, 0.1);
  const cv::Mat wave = one_wave(kN, 3, 5);
  tile.set(wave);
  std::vector<float> row(kN), scratch(2 * kN);
  sample_row(tile, 7 - 3 * kN, 0.1, 0.1, kN, row.data(), scratch.data());
  for (int x = 0; x < kN; ++x) EXPECT_NEAR(row[static_cast<std::size_t>(x)], wave.at<float>(7, x), 1e-6);
}

TEST(HeightField, HasTheSpectrumOfPhillips) {
  // At one moment a wave and its opposite stand on each other: for both directions of the wind as printed.
  WaterMotion water = small_water();
  water.against = 1;
  const Wind wind{.speed_m_per_s = 5, .direction_deg = 30};
  const double length = 5 * 5 / 9.81 / water.roughness;
  const cv::Point2d blows(std::cos(kTurn / 12), std::sin(kTurn / 12));
  constexpr int kFields = 300, kOctaves = 4, kAngles = 3;
  double found[kOctaves][kAngles] = {}, printed[kOctaves][kAngles] = {}, all_found = 0, all_printed = 0;
  for (std::uint64_t seed = 1; seed <= kFields; ++seed) {
    HeightField field(water, wind, kCycle, seed);
    field.go_to(0);
    cv::Mat spectrum;
    cv::dft(field.plane(0), spectrum, cv::DFT_COMPLEX_OUTPUT | cv::DFT_SCALE);
    const int n = field.samples();
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        if (x == n / 2 || y == n / 2 || (x == 0 && y == 0)) continue;
        const cv::Point2d k(kTurn * (x <= n / 2 ? x : x - n) / field.side_m(0),
                            kTurn * (y <= n / 2 ? y : y - n) / field.side_m(0));
        const double s = std::hypot(k.x, k.y), cosine = k.dot(blows) / s;
        const int octave = std::min(kOctaves - 1, static_cast<int>(std::log2(std::hypot(
                                                      x <= n / 2 ? x : x - n, y <= n / 2 ? y : y - n)))),
                  angle = std::min(kAngles - 1, static_cast<int>(kAngles * std::abs(cosine)));
        const cv::Vec2f v = spectrum.at<cv::Vec2f>(y, x);
        // Eq. 11.
        const double power = std::exp(-1 / (s * length * s * length)) / (s * s * s * s) * cosine * cosine;
        found[octave][angle] += v.dot(v), all_found += v.dot(v);
        printed[octave][angle] += power, all_printed += power;
      }
  }
  for (int octave = 0; octave < kOctaves; ++octave)
    for (int angle = 0; angle < kAngles; ++angle)
      EXPECT_NEAR((found[octave][angle] / all_found) / (printed[octave][angle] / all_printed), 1, 0.25)
          << "octave " << octave << ", third " << angle;
}

}  // namespace
}  // namespace freshet::synth::scene
