#include "bench/quality/quality_asked.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::bench {
namespace {

const cv::Size kSize(192, 128);

cv::Mat everywhere() { return cv::Mat(kSize, CV_8U, cv::Scalar(255)); }

cv::Mat grain(std::uint64_t seed) {
  cv::Mat luma(kSize, CV_8U);
  cv::RNG random(seed * 0x9E3779B97F4A7C15u);  // its streams of small seeds are alike
  random.fill(luma, cv::RNG::UNIFORM, 80, 176);
  return luma;
}

TEST(QualityAsked, TheStillItselfCorrelatesWhollyAndOthersNot) {
  const cv::Mat still = grain(1);
  EXPECT_NEAR(detail_correlation(still, still, everywhere()), 1, 1e-6);
  EXPECT_NEAR(detail_correlation(grain(2), still, everywhere()), 0, 0.05);
  EXPECT_NEAR(detail_correlation(255 - still, still, everywhere()), -1, 1e-6);
  EXPECT_EQ(detail_correlation(cv::Mat(kSize, CV_8U, cv::Scalar(90)), still, everywhere()), 0);
}

TEST(QualityAsked, LevelAndContrastDoNotMatterAndOnlyTheMatteCounts) {
  const cv::Mat still = grain(1);
  cv::Mat paler = still / 2 + 90;
  EXPECT_GT(detail_correlation(paler, still, everywhere()), 0.99);
  cv::Mat left = everywhere();
  left(cv::Rect(80, 0, 112, 128)) = 0;
  const double before = detail_correlation(paler, still, left);
  paler(cv::Rect(120, 0, 72, 128)) = 0;  // beyond the blur's reach
  EXPECT_NEAR(detail_correlation(paler, still, left), before, 1e-6);
}

TEST(QualityAsked, HalfNewDetailCorrelatesByItsShareOfDeviation) {
  cv::Mat a, b, mixed;
  grain(1).convertTo(a, CV_32F, 1, -128);
  grain(2).convertTo(b, CV_32F, 1, -128);
  cv::Mat(0.6 * a + 0.8 * b + 128).convertTo(mixed, CV_8U);
  EXPECT_NEAR(detail_correlation(mixed, grain(1), everywhere()), 0.6, 0.03);
}

std::vector<cv::Mat> seconds(const std::vector<cv::Vec2f>& motions) {
  std::vector<cv::Mat> by_second;
  for (const cv::Vec2f& motion : motions)
    by_second.emplace_back(kSize.height / 8, kSize.width / 8, CV_32FC2, cv::Scalar(motion[0], motion[1]));
  return by_second;
}

TEST(QualityAsked, SecondsThatGoBackAreCounted) {
  const cv::Mat down(kSize, CV_32FC2, cv::Scalar(0, 1));
  const Reversals steady = reversals(seconds({{0, 40}, {5, 30}, {30, 20}}), down, everywhere());
  EXPECT_EQ(steady.seconds, 0);
  EXPECT_EQ(steady.blocks, 0);
  const Reversals surf = reversals(seconds({{0, 40}, {0, -20}, {0, 40}, {3, -8}}), down, everywhere());
  EXPECT_EQ(surf.seconds, 2);
  EXPECT_NEAR(surf.blocks, 0.5, 1e-9);
  // What hardly moves has not turned round.
  EXPECT_EQ(reversals(seconds({{0, -0.1f}}), down, everywhere()).seconds, 0);
}

TEST(QualityAsked, PartsThatGoBackAreToldApart) {
  const cv::Mat down(kSize, CV_32FC2, cv::Scalar(0, 1));
  std::vector<cv::Mat> motion = seconds({{0, 40}, {0, 40}});
  motion[1](cv::Rect(0, 0, 6, 16)).setTo(cv::Scalar(0, -10));
  const Reversals part = reversals(motion, down, everywhere());
  EXPECT_EQ(part.seconds, 0);
  EXPECT_NEAR(part.blocks, 0.125, 1e-9);
  cv::Mat right = everywhere();
  right(cv::Rect(0, 0, 96, 128)) = 0;
  EXPECT_EQ(reversals(motion, down, right).blocks, 0);
  cv::Mat asked = down.clone();
  asked(cv::Rect(0, 0, 96, 128)).setTo(cv::Scalar(0, 0));  // nothing is asked there
  EXPECT_EQ(reversals(motion, asked, everywhere()).blocks, 0);
}

TEST(QualityAsked, WhereNothingIsAskedNothingIsKnown) {
  EXPECT_TRUE(std::isnan(reversals(seconds({{1, 1}}), {}, everywhere()).seconds));
  EXPECT_TRUE(std::isnan(reversals(seconds({{1, 1}}), cv::Mat::zeros(kSize, CV_32FC2), everywhere()).blocks));
}

TEST(QualityAsked, ALoopThatReturnsHasWhatAStillHasNot) {
  std::vector<cv::Mat> loop;
  for (int t = 0; t < 16; ++t) loop.push_back(grain(10 + t));
  EXPECT_GT(motion_after_loop(loop, 16, everywhere()), 0.9);  // one period: repeated exactly
  std::vector<cv::Mat> twice = loop;
  twice.insert(twice.end(), loop.begin(), loop.end());
  EXPECT_EQ(motion_after_loop(twice, 16, everywhere()), motion_after_loop(loop, 16, everywhere()));
  std::vector<cv::Mat> endless = loop;
  for (int t = 16; t < 32; ++t) endless.push_back(grain(10 + t));
  EXPECT_NEAR(motion_after_loop(endless, 16, everywhere()), 0, 0.05);
  EXPECT_NEAR(motion_after_loop(std::vector<cv::Mat>(16, loop[0]), 16, everywhere()), 0, 1e-9);
}

}  // namespace
}  // namespace freshet::bench
