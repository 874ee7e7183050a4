#include "bench/quality/quality_structure.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "vision/pyramid.h"

namespace freshet::bench {
namespace {

const cv::Size kSize(320, 256);

cv::Mat everywhere(cv::Size size = kSize) { return cv::Mat(size, CV_8U, cv::Scalar(255)); }

std::vector<cv::Mat> grain(double deviation, std::uint64_t seed, int frames = 16, cv::Size size = kSize) {
  std::vector<cv::Mat> film;
  cv::RNG random(seed * 0x9E3779B97F4A7C15u);  // its streams of small seeds are alike
  for (int t = 0; t < frames; ++t) {
    cv::Mat values(size, CV_32F), luma;
    random.fill(values, cv::RNG::NORMAL, 128, deviation);
    values.convertTo(luma, CV_8U);
    film.push_back(luma);
  }
  return film;
}

TEST(QualityStructure, AFilmIsNoDistanceFromItself) {
  const PatchSample sample = sample_patches(grain(20, 1), everywhere());
  for (const double distance : patch_distances(sample, sample_patches(grain(20, 1), everywhere())))
    EXPECT_EQ(distance, 0);
}

// Projected on unit vectors, white grain's patches are Gaussian; so are its linear bands. Distance of two
// Gaussians of deviations a and b is |a - b| * mean |z|.
TEST(QualityStructure, DistanceOfGrainIsThatOfGaussians) {
  const auto distances =
      patch_distances(sample_patches(grain(10, 1), everywhere()), sample_patches(grain(20, 2), everywhere()));
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(grain(20, 3, 1, {1024, 1024})[0], kPatchLevels - 1, bands);
  for (int l = 0; l < kPatchLevels - 1; ++l) {
    cv::Scalar mean, deviation;
    cv::meanStdDev(bands[l], mean, deviation);
    // Projections of correlated pixels differ in deviation; its mean square is the pixels' own.
    const double expected = deviation[0] / 2 * std::sqrt(2 / std::numbers::pi);
    EXPECT_NEAR(distances[l], expected, 0.12 * expected) << l;
  }
}

// The slow, obvious twin: all patches of one frame that is small enough, sorted and matched one by one.
TEST(QualityStructure, DistanceIsThatOfSortedProjections) {
  const cv::Size size(24, 22);  // 18 x 16 patches at the finest level: all are taken
  const std::vector<cv::Mat> first = grain(30, 4, 1, size), second = grain(12, 5, 1, size);
  const double distance =
      patch_distances(sample_patches(first, everywhere(size)), sample_patches(second, everywhere(size)))[0];
  const auto projected = [&](const cv::Mat& luma, const std::vector<double>& direction) {
    std::vector<cv::Mat> bands;
    vision::laplacian_pyramid(luma, kPatchLevels - 1, bands);
    std::vector<double> values;
    for (int y = 0; y + kPatchSide <= size.height; ++y)
      for (int x = 0; x + kPatchSide <= size.width; ++x) {
        double value = 0;
        for (int i = 0; i < kPatchSide * kPatchSide; ++i)
          value += direction[i] * bands[0].at<float>(y + i / kPatchSide, x + i % kPatchSide);
        values.push_back(value);
      }
    std::sort(values.begin(), values.end());
    return values;
  };
  cv::RNG random(77);  // other directions: their mean is what is measured
  double sum = 0;
  constexpr int kDirections = 400;
  for (int d = 0; d < kDirections; ++d) {
    std::vector<double> direction;
    double length = 0;
    for (int i = 0; i < kPatchSide * kPatchSide; ++i) {
      direction.push_back(random.gaussian(1));
      length += direction[i] * direction[i];
    }
    for (double& value : direction) value /= std::sqrt(length);
    const std::vector<double> a = projected(first[0], direction), b = projected(second[0], direction);
    for (std::size_t i = 0; i < a.size(); ++i)
      sum += std::abs(a[i] - b[i]) / static_cast<double>(a.size() * kDirections);
  }
  EXPECT_NEAR(distance, sum, 0.06 * sum);
}

TEST(QualityStructure, LevelsTellWhichSizeIsMissing) {
  std::vector<cv::Mat> coarse = grain(60, 6), blurred;
  for (cv::Mat& frame : coarse) {
    cv::Mat smooth, values;
    frame.convertTo(values, CV_32F);
    cv::GaussianBlur(values, smooth, {}, 10);
    cv::Mat both;
    cv::addWeighted(values, 0.3, (smooth - 128) * 10 + 128, 1, -0.3 * 128, both);
    both.convertTo(frame, CV_8U);
    cv::Mat without;
    cv::GaussianBlur(frame, without, {}, 1.5);
    blurred.push_back(without);
  }
  const auto distances =
      patch_distances(sample_patches(coarse, everywhere()), sample_patches(blurred, everywhere()));
  EXPECT_GT(distances[0], 5 * distances[4]);
}

TEST(QualityStructure, WhatIsOutsideTheMatteDoesNotCount) {
  std::vector<cv::Mat> film = grain(20, 1);
  cv::Mat matte = everywhere();
  matte(cv::Rect(160, 0, 160, 256)) = 0;
  const PatchSample before = sample_patches(film, matte);
  for (cv::Mat& frame : film)
    frame(cv::Rect(240, 0, 80, 256)) = 0;  // beyond all patches of the coarsest level
  EXPECT_EQ(patch_distances(before, sample_patches(film, matte))[0], 0);
}

TEST(QualityStructure, ALevelWithoutPatchesIsNotMeasured) {
  const PatchSample sample = sample_patches(grain(20, 1, 4, {64, 64}), everywhere({64, 64}));
  const auto distances = patch_distances(sample, sample);
  EXPECT_EQ(distances[0], 0);
  EXPECT_TRUE(std::isnan(distances[4]));  // 4 x 4 px
}

}  // namespace
}  // namespace freshet::bench
