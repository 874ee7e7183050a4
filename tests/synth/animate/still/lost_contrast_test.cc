#include "synth/animate/still/lost_contrast.h"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {
namespace {

constexpr int kWidth = 160, kHeight = 96, kStep = 4;
const LostContrastOptions kWhole{.max_gain = 2};  // all that two copies lose comes back

cv::Mat noise(int seed) {
  cv::Mat luma(kHeight, kWidth, CV_32F);
  cv::RNG random(seed);
  random.fill(luma, cv::RNG::NORMAL, 0.5, 0.1);
  return luma;
}

/// Two copies of equal weight whose sources lie `apart` px from each other.
std::vector<CopyMap> two_copies(float apart) {
  const cv::Size size(kWidth / kStep, kHeight / kStep);
  const cv::Mat half(size, CV_32F, cv::Scalar(0.5));
  return {{half, cv::Mat(size, CV_32FC2, cv::Scalar(0, 0))},
          {half, cv::Mat(size, CV_32FC2, cv::Scalar(apart, 0))}};
}

double deviation(const cv::Mat& luma) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(luma(cv::Rect(20, 20, 120, 56)), mean, deviation);
  return deviation[0];
}

TEST(LostContrast, OfCopiesThatDoNotAgreeComesBack) {
  cv::Mat mixed = 0.5 * noise(1) + 0.5 * noise(2);
  EXPECT_NEAR(deviation(mixed), 0.1 / std::sqrt(2.0), 0.004);
  restore_contrast(mixed, two_copies(100), kStep, {}, {}, kWhole);
  EXPECT_NEAR(deviation(mixed), 0.1, 0.006);
}

TEST(LostContrast, OfCopiesThatAgreeThereIsNone) {
  cv::Mat same = noise(1);
  restore_contrast(same, two_copies(0), kStep, {}, {}, {});
  EXPECT_LT(cv::norm(same, noise(1), cv::NORM_INF), 1e-5);
}

TEST(LostContrast, CoarseDetailAgreesLongerThanFine) {
  // Sources three pixels apart: the finest band is unlike, detail of 32 px nearly the same.
  cv::Mat fine = noise(1), coarse;
  cv::GaussianBlur(noise(2), coarse, {}, 12);
  coarse = 0.5 + 20 * (coarse - 0.5);
  const double before = deviation(coarse), finest = deviation(fine);
  restore_contrast(fine, two_copies(3), kStep, {}, {}, kWhole);
  restore_contrast(coarse, two_copies(3), kStep, {}, {}, kWhole);
  EXPECT_GT(deviation(fine) / finest, 1.25);
  EXPECT_LT(deviation(coarse) / before, 1.06);
}

TEST(LostContrast, LeavesRoomForWhatComesAnew) {
  cv::Mat luma = noise(1);
  const double before = deviation(luma);
  restore_contrast(luma, two_copies(0), kStep, std::vector<double>(5, 0.36), {}, {});
  EXPECT_NEAR(deviation(luma) / before, 0.8, 0.02);
  cv::Mat standing = noise(1);
  restore_contrast(standing, two_copies(0), kStep, std::vector<double>(5, 0.36),
                   cv::Mat(kHeight / kStep, kWidth / kStep, CV_32F, cv::Scalar(0)), {});
  EXPECT_NEAR(deviation(standing) / before, 1, 1e-3);
}

}  // namespace
}  // namespace freshet::synth::animate
