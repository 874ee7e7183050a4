// Waves under a wind that changes: the heights of each moment against Eq. 11 for its wind, phases that go on.
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "synth/scene/water/height_field.h"
#include "synth/scene/wind/gaussian.h"

namespace freshet::synth::scene {
namespace {

constexpr double kFullTurn = 2 * std::numbers::pi, kFall = 9.81;
const Cycle kFilm{.frames = 1200, .fps = 20};

/// From 0 to 20 s calm, from 30 to 50 s a storm of another direction, at 60 s as at 0.
Wind turning_storm(double calm = 4) {
  return {.speed_m_per_s = calm,
          .direction_deg = 30,
          .at = {{.time_s = 20, .speed_m_per_s = calm, .direction_deg = 30},
                 {.time_s = 30, .speed_m_per_s = 9, .direction_deg = 120},
                 {.time_s = 50, .speed_m_per_s = 9, .direction_deg = 120},
                 {.time_s = 60, .speed_m_per_s = calm, .direction_deg = 30}}};
}
WaterMotion sea(double against = 1) {
  return {.tile = 32, .roughness = 4, .amplitude = 1, .against = against};
}

double number_of(int i, int n, double side) { return kFullTurn * (i <= n / 2 ? i : i - n) / side; }

/// Eq. 11.
double printed_power(cv::Point2d k, double speed, double roughness, double direction_deg) {
  const double length = speed * speed / kFall / roughness, s = std::hypot(k.x, k.y);
  const double angle = direction_deg * std::numbers::pi / 180,
               cosine = (k.x * std::cos(angle) + k.y * std::sin(angle)) / s;
  return std::exp(-1 / (s * length * s * length)) / (s * s * s * s) * cosine * cosine;
}

TEST(GrowingWaves, HaveAtEachTimeTheSpectrumOfPhillipsForTheWindOfThatTime) {
  constexpr int kFields = 300, kOctaves = 4, kAngles = 3;
  double found[2][kOctaves][kAngles] = {}, expected[2][kOctaves][kAngles] = {}, whole_found = 0,
         whole_expected = 0;
  for (std::uint64_t seed = 1; seed <= kFields; ++seed) {
    HeightField field(sea(), turning_storm(), kFilm, seed);
    ASSERT_EQ(field.tiles(), 2);  // 81 / 16 < 8
    for (const int storm : {0, 1}) {
      // Windows: a moment is as good as any, and the same waves are seen at several.
      for (const int frame : {0, 170, 390}) {
        field.go_to((storm == 1 ? 600 : 0) + frame);
        cv::Mat spectrum;
        cv::dft(field.plane(0), spectrum, cv::DFT_COMPLEX_OUTPUT | cv::DFT_SCALE);
        const int n = field.samples();
        for (int y = 0; y < n; ++y)
          for (int x = 0; x < n; ++x) {
            if (x == n / 2 || y == n / 2 || (x == 0 && y == 0)) continue;
            const cv::Point2d k(number_of(x, n, field.side_m(0)), number_of(y, n, field.side_m(0)));
            const double steps = std::hypot(k.x, k.y) * field.side_m(0) / kFullTurn;
            const double angle = (storm == 1 ? 120 : 30) * std::numbers::pi / 180;
            const double cosine =
                std::abs(k.x * std::cos(angle) + k.y * std::sin(angle)) / std::hypot(k.x, k.y);
            const int octave = std::min(kOctaves - 1, static_cast<int>(std::log2(steps))),
                      third = std::min(kAngles - 1, static_cast<int>(kAngles * cosine));
            const cv::Vec2f v = spectrum.at<cv::Vec2f>(y, x);
            const double power = printed_power(k, storm == 1 ? 9 : 4, sea().roughness, storm == 1 ? 120 : 30);
            found[storm][octave][third] += v.dot(v), whole_found += v.dot(v);
            expected[storm][octave][third] += power, whole_expected += power;
          }
      }
    }
  }
  // One factor for both: the storm's heights and the calm's are as Eq. 11 has them beside each other.
  for (const int storm : {0, 1})
    for (int octave = 0; octave < kOctaves; ++octave)
      for (int third = 0; third < kAngles; ++third) {
        const double share = found[storm][octave][third] / whole_found,
                     printed = expected[storm][octave][third] / whole_expected;
        if (printed < 1e-9) {
          EXPECT_LT(share, 1e-8);
          continue;
        }
        EXPECT_NEAR(share / printed, 1, 0.25) << storm << ", octave " << octave << ", third " << third;
      }
}

TEST(GrowingWaves, AreTheSumOfTheirHarmonicsEachAsHighAsItsWindMakesIt) {
  const WaterMotion water = sea(0.3);
  const Wind wind = turning_storm();
  HeightField field(water, wind, kFilm, 7);
  const Weather weather(wind, kFilm);
  const int n = field.samples();
  const double side = field.side_m(0);
  const Random random(7, 1000);
  const auto amplitude = [&](int x, int y, const Wind& now) {
    const cv::Point2d k(number_of(x, n, side), number_of(y, n, side));
    const double angle = now.direction_deg * std::numbers::pi / 180;
    const double into = k.x * std::cos(angle) + k.y * std::sin(angle) > 0 ? 0.3 : 1;
    return into * std::sqrt(printed_power(k, now.speed_m_per_s, water.roughness, now.direction_deg));
  };
  double strongest = 0;
  const auto skipped = [&](int x, int y) { return x == n / 2 || y == n / 2 || (x == 0 && y == 0); };
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      if (!skipped(x, y)) strongest += 2 * std::pow(amplitude(x, y, weather.strongest()), 2);
  const double scale = field.deviation_m() / std::sqrt(2 * strongest);
  for (const int frame : {10, 470, 533, 700, 1133}) {
    field.go_to(frame);
    const Wind now = weather.at_frame(frame);
    for (const cv::Point at : {cv::Point(0, 0), cv::Point(5, 17), cv::Point(30, 2)}) {
      std::complex<double> sum = 0;
      for (int x = 0; x < n; ++x)
        for (int y = 0; y < n; ++y) {
          if (skipped(x, y)) continue;
          const auto index = [&](int column, int row) {
            return static_cast<std::uint64_t>(column) * 32 + static_cast<std::uint64_t>(row);
          };
          const double omega = std::sqrt(kFall * std::hypot(number_of(x, n, side), number_of(y, n, side)));
          const double harmonic = std::max(1.0, std::round(omega * kFilm.seconds() / kFullTurn));
          const std::complex<double> turn = std::polar(1.0, kFullTurn * harmonic * frame / kFilm.frames);
          const int back_x = (n - x) % n, back_y = (n - y) % n;
          const std::complex<double> height =
              scale * (complex_gaussian(random, index(x, y)) * amplitude(x, y, now) * turn +
                       std::conj(complex_gaussian(random, index(back_x, back_y)) *
                                 amplitude(back_x, back_y, now) * turn));
          sum += height * std::polar(1.0, kFullTurn * (x * at.x + y * at.y) / n);
        }
      EXPECT_NEAR(field.plane(0).at<float>(at), sum.real(), 1e-3 * field.deviation_m()) << frame;
    }
  }
}

TEST(GrowingWaves, UnderKeysThatSayWhatTheWindIsAreThoseWithoutKeys) {
  const Wind steady{.speed_m_per_s = 6, .direction_deg = 40};
  Wind keyed = steady;
  keyed.at = {{.time_s = 10, .speed_m_per_s = 6}};
  for (const auto what : {HeightField::What::kHeights, HeightField::What::kSlopes}) {
    HeightField plain(sea(0.3), steady, kFilm, 5, what), same(sea(0.3), keyed, kFilm, 5, what);
    for (const int frame : {0, 77}) {
      plain.go_to(frame), same.go_to(frame);
      for (int p = 0; p < plain.planes(); ++p)
        EXPECT_LT(cv::norm(plain.plane(p), same.plane(p), cv::NORM_INF),
                  1e-4 * cv::norm(plain.plane(p), cv::NORM_INF));
    }
  }
}

TEST(GrowingWaves, OfACalmMuchLessThanTheStormHaveSmallerTiles) {
  // With them the calm's waves are as high as alone, though the storm's tiles hold none as short.
  WaterMotion fine = sea();
  fine.tile = 128;
  double alone = 0, found = 0, storm = 0, steady = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    HeightField field(fine, turning_storm(1.5), kFilm, seed), calm(fine, {.speed_m_per_s = 1.5}, kFilm, seed),
        high(fine, {.speed_m_per_s = 9}, kFilm, seed);
    ASSERT_EQ(field.tiles(), 4);
    EXPECT_DOUBLE_EQ(field.side_m(2), field.side_m(0) / 8);
    const auto power = [](HeightField& of, int frame) {
      of.go_to(frame);
      double sum = 0;
      for (int p = 0; p < of.planes(); ++p) sum += of.plane(p).dot(of.plane(p)) / of.plane(p).total();
      return sum;
    };
    found += power(field, 100), alone += power(calm, 100);
    storm += power(field, 700), steady += power(high, 700);
  }
  EXPECT_NEAR(found / alone, 1, 0.3);
  EXPECT_NEAR(storm / steady, 1, 0.3);
}

TEST(GrowingWaves, NeverStepFurtherThanInAStormThatStaysAndRepeatToTheBit) {
  HeightField field(sea(0.3), turning_storm(1.5), kFilm, 4);
  const auto sum = [](HeightField& of, int frame) {
    of.go_to(frame);
    std::vector<cv::Mat> planes;
    for (int p = 0; p < of.planes(); ++p) planes.push_back(of.plane(p).clone());
    return planes;
  };
  const auto step = [&](HeightField& of, int frame) {
    const std::vector<cv::Mat> now = sum(of, frame), next = sum(of, frame + 1);
    double square = 0;
    for (std::size_t p = 0; p < now.size(); ++p)
      square += std::pow(cv::norm(now[p], next[p], cv::NORM_L2), 2);
    return std::sqrt(square);
  };
  double usual = 0, most = 0;
  // From 30 to 50 s the storm stays.
  for (int frame = 600; frame < 1000; frame += 7) usual = std::max(usual, step(field, frame));
  for (int frame = 0; frame < 1200; frame += 11) most = std::max(most, step(field, frame));
  for (const int frame : {399, 400, 599, 600, 999, 1000, 1199}) most = std::max(most, step(field, frame));
  EXPECT_LT(most, 1.1 * usual);

  const std::vector<cv::Mat> first = sum(field, 0), middle = sum(field, 501);
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<cv::Mat> again = sum(field, kFilm.frames), once_more = sum(field, 501 - kFilm.frames);
  for (std::size_t p = 0; p < first.size(); ++p) {
    EXPECT_EQ(cv::norm(first[p], again[p], cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(middle[p], once_more[p], cv::NORM_INF), 0);
  }
}

TEST(GrowingWaves, LieDownWhereTheWindDoes) {
  Wind wind{.speed_m_per_s = 0,
            .at = {{.time_s = 20, .speed_m_per_s = 8}, {.time_s = 60, .speed_m_per_s = 0}}};
  HeightField field(sea(), wind, kFilm, 1);
  field.go_to(0);
  for (int p = 0; p < field.planes(); ++p) EXPECT_EQ(cv::norm(field.plane(p), cv::NORM_INF), 0);
  field.go_to(400);
  EXPECT_GT(cv::norm(field.plane(0), cv::NORM_INF), 0);
  wind.at.resize(1);
  wind.at[0].speed_m_per_s = 0;
  HeightField never(sea(), wind, kFilm, 1);
  never.go_to(400);
  EXPECT_EQ(cv::norm(never.plane(0), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace freshet::synth::scene
