#include "synth/animate/still/band_contrast.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/harness/noise.h"
#include "vision/pyramid.h"

namespace freshet::synth::animate {
namespace {

const cv::Size kSize(512, 320);
constexpr int kLevels = 4;

/// Mean squares of the bands of a part of a picture.
std::vector<double> powers(const cv::Mat& of, const cv::Rect& part) {
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(of, kLevels, bands);
  std::vector<double> out;
  for (int level = 0; level < kLevels; ++level) {
    const cv::Mat band =
        bands[level](cv::Rect(part.x >> level, part.y >> level, part.width >> level, part.height >> level));
    out.push_back(cv::norm(band, cv::NORM_L2SQR) / static_cast<double>(band.total()));
  }
  return out;
}

TEST(BandContrast, DetailGetsItsShareOfEachBandPlaceByPlace) {
  // Twice as much contrast on the right.
  cv::Mat picture = normal_noise(kSize, 1, 0, 0.05);
  picture(cv::Rect(256, 0, 256, 320)) *= 2;
  const BandContrast contrast(picture, kLevels, Neighbourhood::kClose);
  cv::Mat detail = normal_noise(kSize, 2, 0, 0.01);
  const std::vector<double> shares{0.1, 0.2, 0.4, 0.4};
  contrast.take_share(detail, shares, 1000, 1e-6);
  for (const cv::Rect part : {cv::Rect(16, 16, 160, 288), cv::Rect(336, 16, 160, 288)}) {
    // The pyramid's bands overlap: a band with more than its finer neighbour loses some to it.
    const std::vector<double> whole = powers(picture, part), own = powers(detail, part);
    for (int level = 0; level < kLevels; ++level)
      EXPECT_NEAR(own[level] / whole[level] / shares[level], 1, 0.5) << level;
  }
}

TEST(BandContrast, DetailComesWhereThePictureHasItAndNotBesideIt) {
  // Stripes of 24 px with detail, as wide ones without.
  cv::Mat picture = normal_noise(kSize, 1, 0, 0.05);
  for (int x = 0; x < kSize.width; x += 48) picture.colRange(x, std::min(x + 24, kSize.width)).setTo(0);
  const BandContrast close(picture, kLevels, Neighbourhood::kClose),
      wide(picture, kLevels, Neighbourhood::kWide);
  const auto smooth_of_lively = [&](const BandContrast& contrast) {
    cv::Mat detail = normal_noise(kSize, 2, 0, 0.01);
    contrast.take_share(detail, std::vector<double>{0.25, 0, 0, 0}, 1000, 1e-6);
    // Fourteen pixels in the middle of a stripe.
    return cv::norm(detail.colRange(48 * 5 + 5, 48 * 5 + 19)) /
           cv::norm(detail.colRange(48 * 5 + 29, 48 * 5 + 43));
  };
  EXPECT_LT(smooth_of_lively(close), 0.1);
  EXPECT_GT(smooth_of_lively(wide), 0.7);
}

TEST(BandContrast, NoiseIsNotAmplified) {
  const BandContrast contrast(normal_noise(kSize, 1, 0, 0.05), kLevels, Neighbourhood::kClose);
  const std::vector<double> shares(kLevels, 0.25);
  cv::Mat faint = normal_noise(kSize, 2, 0, 0.0005), limited = normal_noise(kSize, 2, 0, 0.001);
  const double before = cv::norm(faint), of_limited = cv::norm(limited);
  contrast.take_share(faint, shares, 1000, 0.003);
  EXPECT_LT(cv::norm(faint), 10 * before);  // to the full share it would be 50 times
  contrast.take_share(limited, shares, 4, 1e-6);
  EXPECT_LE(cv::norm(limited), 4.2 * of_limited);
}

TEST(BandContrast, WithoutAShareNothingIsLeft) {
  const BandContrast contrast(normal_noise(kSize, 1, 0, 0.05), kLevels, Neighbourhood::kClose);
  cv::Mat detail = normal_noise(kSize, 2, 0, 0.05);
  contrast.take_share(detail, std::vector<double>(kLevels, 0.0), 4, 0.003);
  EXPECT_EQ(cv::norm(detail, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace freshet::synth::animate
