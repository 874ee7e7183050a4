#include "vision/loop_rule.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::vision {
namespace {

/// A texture that sways from side to side: positions repeat twice a period, motion once.
cv::Mat swaying(double frame, double period) {
  static const cv::Mat texture = [] {
    cv::Mat noise(80, 160, CV_8U);
    cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 255);
    cv::GaussianBlur(noise, noise, {}, 3);
    cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
    return noise;
  }();
  const double x = 40 + 20 * std::sin(2 * std::numbers::pi * frame / period);
  cv::Mat out;
  cv::getRectSubPix(texture, {64, 48}, {static_cast<float>(x + 32), 40}, out);
  return out;
}

std::optional<LoopRule> rule_of(std::uint32_t frames, double period, double fps = 25) {
  LoopFinder finder(fps);
  for (std::uint32_t i = 0; i < frames; ++i) finder.add(swaying(i, period));
  return finder.finish();
}

TEST(LoopRule, JoinsAtAWholeNumberOfPeriodsAsLongAsCanBe) {
  const auto rule = rule_of(100, 30);
  ASSERT_TRUE(rule);
  EXPECT_EQ(rule->length(), 60U);
  EXPECT_LT(rule->distance, 0.02);
  EXPECT_GE(rule->to, rule->fade / 2);
  EXPECT_LT(rule->from + rule->fade / 2, 100U);
}

TEST(LoopRule, DoesNotJoinToAFrameThatLooksTheSameAndMovesTheOtherWay) {
  // At the middle of its swing the texture comes by twice a period. Frames that pass it in opposite
  // directions are the same picture; a rule that compared single frames would take the longest loop of that
  // kind.
  const auto rule = rule_of(70, 40);
  ASSERT_TRUE(rule);
  EXPECT_EQ(rule->length(), 40U);
  EXPECT_LT(rule->distance, 0.02);
}

TEST(LoopRule, IsNoneForAClipThatIsTooShort) {
  EXPECT_FALSE(rule_of(kMinLoopFrames - 1, 8));
  EXPECT_FALSE(rule_of(0, 8));
  for (const double fps : {0.5, 25.0, 240.0}) {
    const auto rule = rule_of(kMinLoopFrames, 14, fps);
    ASSERT_TRUE(rule) << fps;
    EXPECT_GE(rule->length(), 12U);
    EXPECT_GE(rule->to, rule->fade / 2);
    EXPECT_LT(rule->from + rule->fade / 2, kMinLoopFrames);
  }
}

TEST(LoopRule, IsNoShorterThanHalfTheClip) {
  for (const double period : {10.0, 14.0, 31.0}) {
    const auto rule = rule_of(75, period);
    ASSERT_TRUE(rule);
    EXPECT_GE(rule->length(), 37U) << period;
  }
}

TEST(LoopRule, OfALongClipTheMiddleIsForgotten) {
  const auto rule = rule_of(2600, 50);
  ASSERT_TRUE(rule);
  EXPECT_EQ(rule->length() % 50, 0U);
  EXPECT_GT(rule->length(), 2000U);
  EXPECT_LT(rule->distance, 0.02);
  EXPECT_LT(rule->from + rule->fade / 2, 2600U);
}

TEST(LoopRule, OfASceneThatStandsStillIsStillARule) {
  LoopFinder finder(25);
  const cv::Mat grey(48, 64, CV_8U, cv::Scalar(90));
  for (int i = 0; i < 60; ++i) finder.add(grey);
  const auto rule = finder.finish();
  ASSERT_TRUE(rule);
  EXPECT_EQ(rule->distance, 0);
  EXPECT_GT(rule->length(), 40U);
}

}  // namespace
}  // namespace freshet::vision
