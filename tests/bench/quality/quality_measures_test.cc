#include "bench/quality/quality_measures.h"

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::bench {
namespace {

constexpr double kFps = 25;
const cv::Size kSize(192, 144);

using Shade = std::function<double(int x, int y, int t)>;

/// A number that looks random, the same for the same arguments.
unsigned grain_at(unsigned x, unsigned y, unsigned t) {
  unsigned value = x * 0x9E3779B1u ^ (y * 0x85EBCA77u + 0x27220A95u) ^ (t * 0xC2B2AE3Du + 0x165667B1u);
  value = (value ^ (value >> 15)) * 0x2C1B3C6Du;
  value = (value ^ (value >> 12)) * 0x297A2D39u;
  return value ^ (value >> 15);
}

std::vector<cv::Mat> film_of(const Shade& shade, int frames = 40, cv::Size size = kSize) {
  std::vector<cv::Mat> film;
  for (int t = 0; t < frames; ++t) {
    cv::Mat frame(size, CV_8U);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        frame.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(shade(x, y, t));
    film.push_back(frame);
  }
  return film;
}

/// Grain that slides by (dx, dy) px per frame.
std::vector<cv::Mat> sliding(int dx, int dy, int frames = 40) {
  cv::Mat grain(600, 600, CV_8U), smooth;
  cv::RNG random(5);
  random.fill(grain, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(grain, smooth, {}, 2);
  cv::normalize(smooth, smooth, 0, 255, cv::NORM_MINMAX);
  std::vector<cv::Mat> film;
  for (int t = 0; t < frames; ++t)
    film.push_back(smooth(cv::Rect(200 - dx * t, 200 - dy * t, kSize.width, kSize.height)).clone());
  return film;
}

std::vector<PairMotion> motions_of(cv::Vec2f px_per_frame, int frames = 40, cv::Size size = kSize) {
  const cv::Size cells(size.width / kMotionCell, size.height / kMotionCell);
  const PairMotion motion{cv::Mat(cells, CV_32FC2, cv::Scalar(px_per_frame[0], px_per_frame[1])),
                          cv::Mat(cells, CV_32F, cv::Scalar(cv::norm(px_per_frame)))};
  return std::vector<PairMotion>(frames - 1, motion);
}

Region everywhere(cv::Size size = kSize) { return {cv::Mat(size, CV_8U, cv::Scalar(255)), {0, 0}, 24}; }

Film film_with(const Shade& shade, cv::Vec2f motion = {0, 0}) {
  return measure(film_of(shade), motions_of(motion), kFps, everywhere());
}

TEST(QualityMeasures, AreZeroBetweenAFilmAndItself) {
  const std::vector<cv::Mat> film = sliding(2, 1);
  const Film truth = measure(film, pair_motions(film), kFps, everywhere());
  const Distance same = compare(truth, truth, everywhere());
  EXPECT_EQ(same.spectrum_db, 0);
  EXPECT_EQ(same.matte_db, 0);
  EXPECT_NEAR(same.angle_deg, 0, 1e-6);
  EXPECT_EQ(same.speed, 0);
  EXPECT_EQ(same.block_speed, 0);
  EXPECT_EQ(same.texture, 0);
  EXPECT_EQ(same.flicker, 0);
  EXPECT_NEAR(same.ssim, 1, 1e-4);
  EXPECT_EQ(same.moving, 1);
}

TEST(QualityMeasures, AStillIsFarAndDead) {
  const std::vector<cv::Mat> film = sliding(2, 1), still(film.size(), film[20]);
  const Film truth = measure(film, pair_motions(film), kFps, everywhere());
  const Distance floor =
      compare(measure(still, pair_motions(still), kFps, everywhere()), truth, everywhere());
  EXPECT_GT(floor.spectrum_db, 30);
  EXPECT_LT(floor.speed, -4);
  EXPECT_EQ(floor.dead, 1);
  EXPECT_LT(floor.flicker, -3);
  EXPECT_LT(floor.texture, 0.1);
}

TEST(QualityMeasures, FlowFollowsWhatSlides) {
  const std::vector<cv::Mat> film = sliding(2, -1);
  const Film truth = measure(film, pair_motions(film), kFps, everywhere());
  const cv::Scalar mean = cv::mean(truth.motion);
  EXPECT_NEAR(mean[0], 2 * kFps, 3);
  EXPECT_NEAR(mean[1], -1 * kFps, 3);
}

TEST(QualityMeasures, PowerIsASinusoidsInItsBand) {
  // 4 periods in a window of 32 frames, amplitude 30: power 450.
  const Film film =
      film_with([](int, int, int t) { return 128 + 30 * std::sin(2 * std::numbers::pi * 4 * t / 32.0); });
  const auto bands = spectrum_bands(40);
  double all = 0, near = 0;
  for (int b = 0; b < kSpectrumBands; ++b) {
    all += film.power.at<float>(0, b);
    if (bands[b] <= 5 && bands[b + 1] > 3) near += film.power.at<float>(0, b);
  }
  EXPECT_NEAR(all, 450, 5);
  EXPECT_NEAR(near, 450, 10);
}

// The slow, obvious twin: one complex sum per pixel, window and frequency.
TEST(QualityMeasures, PowerIsTheFourierTransforms) {
  for (const int frames : {27, 40, 75}) {
    std::mt19937 random(3);
    const cv::Size size(32, 16);
    const std::vector<cv::Mat> film = film_of([&](int, int, int) { return random() % 256; }, frames, size);
    const Film measured = measure(film, motions_of({0, 0}, frames, size), kFps, everywhere(size));
    const auto bands = spectrum_bands(frames);
    const std::vector<int> starts = spectrum_windows(frames);
    const int length = std::min(frames, 32);
    for (int block = 0; block < 2; ++block) {
      for (int b = 0; b < kSpectrumBands; ++b) {
        double power = 0;
        for (const int start : starts) {
          for (int i = 0; i < 256; ++i) {
            const auto at = [&](int t) {
              return film[start + t].at<std::uint8_t>(i / 16, 16 * block + i % 16);
            };
            double mean = 0;
            for (int t = 0; t < length; ++t) mean += at(t) / static_cast<double>(length);
            for (int k = bands[b]; k < bands[b + 1]; ++k) {
              std::complex<double> sum = 0;
              double squares = 0;
              for (int t = 0; t < length; ++t) {
                const double window = std::pow(std::sin(std::numbers::pi * (t + 0.5) / length), 2);
                squares += window * window;
                sum += (at(t) - mean) * window * std::polar(1.0, -2 * std::numbers::pi * k * t / length);
              }
              power += (2 * k == length ? 1 : 2) * std::norm(sum) / (length * squares);
            }
          }
        }
        power /= 256 * static_cast<double>(starts.size());
        EXPECT_NEAR(measured.power.at<float>(block, b), power, 1e-3 * power) << frames << " " << b;
      }
    }
  }
}

TEST(QualityMeasures, WindowsAndBandsLeaveNothingOut) {
  for (const int frames : {8, 24, 31, 32, 33, 53, 75, 150}) {
    const std::vector<int> starts = spectrum_windows(frames);
    const int length = std::min(frames, kSpectrumWindow);
    EXPECT_EQ(starts.front(), 0);
    EXPECT_EQ(starts.back(), frames - length) << frames;
    for (std::size_t i = 1; i < starts.size(); ++i)
      EXPECT_LE(starts[i] - starts[i - 1], length / 2) << frames;
    const auto bands = spectrum_bands(frames);
    EXPECT_EQ(bands.front(), 1);
    EXPECT_EQ(bands.back(), length / 2 + 1) << frames;
    for (int b = 0; b < kSpectrumBands; ++b) EXPECT_LE(bands[b], bands[b + 1]);
  }
  EXPECT_EQ(spectrum_bands(75), (std::array<int, kSpectrumBands + 1>{1, 2, 3, 4, 5, 6, 8, 12, 17}));
}

TEST(QualityMeasures, HalfTheChangeIsSixDecibels) {
  const auto wobble = [](double amplitude) {
    return [amplitude](int x, int y, int t) {
      return 128 + amplitude * std::cos(1.7 * t + 0.1 * t * t + 0.3 * x + 0.2 * y);
    };
  };
  const Distance distance = compare(film_with(wobble(50)), film_with(wobble(100)), everywhere());
  EXPECT_NEAR(distance.spectrum_db, 6.02, 0.3);
  EXPECT_NEAR(distance.matte_db, 6.02, 0.3);
}

TEST(QualityMeasures, PowerOfTheMatteDoesNotAskWhere) {
  const auto left = [](int x, int, int t) {
    return x < 96 ? 128 + 60 * std::cos(1.7 * t + 0.1 * t * t) : 90;
  };
  const auto right = [&](int x, int y, int t) { return left(kSize.width - 1 - x, y, t); };
  const Distance distance = compare(film_with(left), film_with(right), everywhere());
  EXPECT_GT(distance.spectrum_db, 30);
  EXPECT_NEAR(distance.matte_db, 0, 1e-3);
}

TEST(QualityMeasures, AnglesAndSpeedsAreThoseOfTheFlow) {
  const auto grain = [](int x, int y, int) { return (x * 7 + y * 13) % 200; };
  const Film truth = film_with(grain, {1, 0});
  const Distance across = compare(film_with(grain, {0, 2}), truth, everywhere());
  EXPECT_NEAR(across.angle_deg, 90, 1e-3);
  EXPECT_NEAR(across.speed, 1, 1e-5);
  EXPECT_NEAR(across.block_speed, 1, 1e-5);
  EXPECT_NEAR(compare(film_with(grain, {-1, 0}), truth, everywhere()).angle_deg, 180, 1e-3);
  EXPECT_NEAR(compare(film_with(grain, {0.5f, 0.5f}), truth, everywhere()).angle_deg, 45, 1e-3);
  EXPECT_NEAR(compare(film_with(grain, {0, 0}), truth, everywhere()).angle_deg, 90, 1e-3);
  // 0.05 px per frame is 1.25 px/s: too slow to have a direction.
  EXPECT_EQ(compare(truth, film_with(grain, {0.05f, 0}), everywhere()).moving, 0);
}

TEST(QualityMeasures, PaceCountsWhatTheMeanMotionLoses) {
  // To and fro: no mean motion, a pace of 2 px per frame.
  std::vector<PairMotion> swaying = motions_of({2, 0});
  for (std::size_t i = 0; i < swaying.size(); i += 2) swaying[i] = motions_of({-2, 0}, 2)[0];
  const std::vector<cv::Mat> luma = film_of([](int x, int y, int) { return (x * 7 + y * 13) % 200; });
  const Film film = measure(luma, swaying, kFps, everywhere());
  EXPECT_NEAR(film.pace, 2 * kFps, 1e-3);
  EXPECT_LT(cv::norm(film.motion.at<cv::Vec2f>(3, 3)), 2 * kFps / 30);
  EXPECT_NEAR(compare(film, measure(luma, motions_of({0, 4}), kFps, everywhere()), everywhere()).pace, -1,
              1e-5);
}

TEST(QualityMeasures, SecondsFollowEachOther) {
  std::vector<PairMotion> turning =
      motions_of({1, 0}, 64);  // 63 pairs: 25, 25 and 13, more than half a second
  for (std::size_t i = 25; i < turning.size(); ++i) turning[i] = motions_of({0, -1}, 2)[0];
  const std::vector<cv::Mat> seconds = motion_by_second(turning, kFps);
  ASSERT_EQ(seconds.size(), 3u);
  EXPECT_NEAR(seconds[0].at<cv::Vec2f>(2, 2)[0], kFps, 1e-3);
  EXPECT_NEAR(seconds[1].at<cv::Vec2f>(2, 2)[1], -kFps, 1e-3);
  EXPECT_NEAR(seconds[2].at<cv::Vec2f>(2, 2)[1], -kFps, 1e-3);
  turning.resize(62);
  EXPECT_EQ(motion_by_second(turning, kFps).size(), 2u);
}

TEST(QualityMeasures, PatchesAreComparedWithTheHalvesOfTheTruth) {
  const auto shade = [](unsigned seed) {
    return [seed](int x, int y, int t) { return grain_at(x, y, t + seed) % 200; };
  };
  Film truth = film_with(shade(0));
  const Film other = film_with([&](int x, int y, int t) { return shade(999)(x, y, t) / 2; });
  EXPECT_TRUE(std::isnan(compare(other, truth, everywhere()).patches[0]));
  truth.halves_apart.fill(1);
  const Distance apart = compare(other, truth, everywhere());
  truth.halves_apart.fill(2);
  const Distance half_as_far = compare(other, truth, everywhere());
  EXPECT_GT(apart.patches[0], 1);
  EXPECT_NEAR(half_as_far.patches[0], apart.patches[0] / 2, 1e-9);
  EXPECT_EQ(compare(truth, truth, everywhere()).patches[0], 0);
}

TEST(QualityMeasures, RibbonIsTheRatioOfCoherence) {
  const Film stripes = film_with([](int x, int, int t) { return 128 + 80 * std::sin(0.4 * x + 0.3 * t); });
  const Film grain = film_with([](int x, int y, int t) { return grain_at(x, y, t) % 200; });
  EXPECT_LT(compare(grain, stripes, everywhere()).ribbon, -1.5);
  EXPECT_NEAR(compare(grain, stripes, everywhere()).ribbon, -compare(stripes, grain, everywhere()).ribbon,
              1e-9);
}

TEST(QualityMeasures, LifetimeIsThatOfTheFilmsOwnFlow) {
  const std::vector<cv::Mat> film = sliding(2, 1), still(film.size(), film[20]);
  const Film truth = measure(film, pair_motions(film), kFps, everywhere());
  EXPECT_GT(truth.lifetime[10], 0.9);
  const std::vector<cv::Mat> new_each = film_of([](int x, int y, int t) { return grain_at(x, y, t) % 200; });
  const Film renewed = measure(new_each, pair_motions(new_each), kFps, everywhere());
  EXPECT_LT(renewed.half_life_s, 0.1);
  EXPECT_GT(compare(renewed, truth, everywhere()).lifetime, 0.6);
  EXPECT_TRUE(std::isnan(film_with([](int, int, int) { return 0; }).half_life_s));  // no fine flow
}

TEST(QualityMeasures, TextureIsContrast) {
  const auto grain = [](double contrast) {
    return [contrast](int x, int y, int t) { return 128 + contrast * ((x * 31 + y * 17 + 3 * t) % 64 - 32); };
  };
  const Distance distance = compare(film_with(grain(1)), film_with(grain(2)), everywhere());
  EXPECT_NEAR(distance.contrast, -1, 0.02);
  EXPECT_NEAR(distance.texture, 1, 0.02);
}

TEST(QualityMeasures, FlickerIsTheLevelsDeviation) {
  const auto breathing = [](double swing) {
    return [swing](int x, int y, int t) { return (x + y) % 32 + 100 + (t % 2 == 0 ? swing : -swing); };
  };
  EXPECT_NEAR(film_with(breathing(8)).flicker, 8, 1e-6);
  EXPECT_NEAR(compare(film_with(breathing(8)), film_with(breathing(2)), everywhere()).flicker, 2, 1e-6);
}

TEST(QualityMeasures, DeadIsTheShareThatNeverMoves) {
  const Film film = film_with([](int x, int, int t) { return x < 48 ? 100 : 100 + 10 * (t % 2); });
  EXPECT_NEAR(film.dead, 0.25, 1e-9);
}

TEST(QualityMeasures, SeamsShowWherePiecesMeet) {
  // Squares of `side` px from (at, at), each of which flickers by itself over a little grain.
  const auto squares = [](int side, int at) {
    return film_of([=](int x, int y, int t) {
      const int column = (x - at + side) / side, row = (y - at + side) / side;
      return 100 + grain_at(column, row, 500 + t) % 40 + grain_at(x, y, t) % 8;
    });
  };
  EXPECT_GT(seam_of(squares(24, 0), everywhere()), 2);
  EXPECT_NEAR(seam_of(squares(24, 12), everywhere()), 0, 0.1);  // on another lattice
  EXPECT_NEAR(seam_of(squares(8, 0), everywhere()), 0, 0.1);    // a codec's blocks
  EXPECT_NEAR(seam_of(film_of([](int x, int y, int t) { return grain_at(x, y, t) % 256; }), everywhere()), 0,
              0.05);
  Region shifted = everywhere();
  shifted.border = {12 - 24, 12};
  EXPECT_GT(seam_of(squares(24, 12), shifted), 2);
}

TEST(QualityMeasures, WhatIsOutsideTheMatteDoesNotCount) {
  const auto film = [](bool garbage) {
    return [garbage](int x, int y, int t) {
      if (garbage && x >= 128) return static_cast<double>(grain_at(x, y, t) % 256);
      return 128 + 50 * std::sin(0.4 * x + 0.3 * y + 0.9 * t);
    };
  };
  Region left = everywhere();
  left.matte(cv::Rect(64, 0, 128, 144)) = 0;
  const auto measured = [&](bool garbage) {
    return measure(film_of(film(garbage)), motions_of({1, 0}), kFps, left);
  };
  const Distance distance = compare(measured(true), measured(false), left);
  EXPECT_EQ(distance.spectrum_db, 0);
  EXPECT_EQ(distance.texture, 0);
  EXPECT_NEAR(distance.ssim, 1, 1e-6);
  EXPECT_EQ(distance.flicker, 0);
  EXPECT_EQ(measured(true).seam, measured(false).seam);
  EXPECT_EQ(measured(true).dead, measured(false).dead);
}

}  // namespace
}  // namespace freshet::bench
