#include "synth/animate/still/layout_share.h"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {
namespace {

constexpr int kWidth = 256, kHeight = 192, kStep = 4, kLevels = 4;
const cv::Size kSamples(kWidth / kStep, kHeight / kStep);

cv::Mat noise(int seed) {
  cv::Mat luma(kHeight, kWidth, CV_32F);
  cv::RNG random(seed);
  random.fill(luma, cv::RNG::NORMAL, 0, 0.3);
  cv::GaussianBlur(luma, luma, {}, 1.5);
  return luma + 0.5;
}

/// The share of the left half, and that of the right.
LayoutShare halves(float left, float right) {
  cv::Mat share(kSamples, CV_32F, cv::Scalar(left));
  share.colRange(kSamples.width / 2, kSamples.width) = right;
  return {std::vector<cv::Mat>(kLevels, share), cv::Mat(kHeight, kWidth, CV_32F, cv::Scalar(1))};
}

StandingLayout layout_of(const cv::Mat& luma) {
  const cv::Mat matte(luma.size(), CV_32F, cv::Scalar(1));
  return {
      FluidPlanes{luma, luma * 0, luma * 0, matte}, matte,
      LayoutMotion{cv::Mat(kSamples, CV_32FC2, cv::Scalar(0, 1)), cv::Mat(kSamples, CV_32F, cv::Scalar(200))},
      std::vector<double>(kLevels, 0.2)};
}

double deviation(const cv::Mat& luma) {
  cv::Scalar mean, found;
  cv::meanStdDev(luma, mean, found);
  return found[0];
}

double most_apart(const cv::Mat& a, const cv::Mat& b, const cv::Rect& where) {
  return cv::norm(a(where), b(where), cv::NORM_INF);
}

TEST(LayoutShare, ShowsEachKindWhereItIs) {
  const cv::Mat laid = noise(1), goes = noise(2);
  const LayoutShare share = halves(0, 1);
  EXPECT_TRUE(share.stands_somewhere());
  EXPECT_TRUE(share.goes_somewhere());
  EXPECT_NEAR(share.mean(), 0.5, 1e-6);
  cv::Mat mixed = goes.clone();
  share.mix(laid, layout_of(noise(3)), mixed);
  // Beyond the reach of the coarsest level.
  EXPECT_LT(most_apart(mixed, goes, {0, 0, 64, kHeight}), 1e-4);
  EXPECT_LT(most_apart(mixed, laid, {192, 0, 64, kHeight}), 1e-4);
}

TEST(LayoutShare, BetweenKeepsTheContrast) {
  const cv::Mat still = noise(3);
  const StandingLayout layout = layout_of(still);
  cv::Mat mixed = noise(2);
  halves(0.5f, 0.5f).mix(noise(1), layout, mixed);
  EXPECT_NEAR(deviation(mixed) / deviation(still), 1, 0.15);
}

TEST(LayoutShare, IsOneKindAloneWithoutTheOther) {
  EXPECT_FALSE(halves(0.01f, 0).stands_somewhere());
  EXPECT_FALSE(halves(1, 0.99f).goes_somewhere());
  EXPECT_FALSE(LayoutShare(0).stands_somewhere());
  EXPECT_FALSE(LayoutShare(1).goes_somewhere());
}

}  // namespace
}  // namespace freshet::synth::animate
