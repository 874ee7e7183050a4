#include "bench/quality/quality_rivals.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/bench/quality/still_and_flow.h"

namespace freshet::bench {
namespace {

const cv::Size kSize(160, 120);

cv::Mat picture() { return grain_of(kSize, 2); }
cv::Mat everywhere() { return all_of(kSize); }
cv::Mat constant(float u, float v) { return flow_of(kSize, u, v); }

TEST(QualityRivals, BeginAndEndWithTheStill) {
  const std::vector<cv::Mat> flow{constant(1.3f, -0.7f)};
  const std::vector<cv::Mat> made = carry_still(picture(), everywhere(), flow, 12);
  ASSERT_EQ(made.size(), 12u);
  EXPECT_EQ(levels_apart(made.front(), picture()), 0);
  EXPECT_EQ(levels_apart(made.back(), picture()), 0);
  EXPECT_GT(levels_apart(made[6], picture()), 5);
}

TEST(QualityRivals, CopiesGoAsFarAsTheFlow) {
  const int frames = 9;
  const std::vector<cv::Mat> flow{constant(2, 1)};
  const cv::Mat still = picture();
  const std::vector<cv::Mat> made = carry_still(still, everywhere(), flow, frames);
  const cv::Rect middle(40, 30, 80, 60);
  for (int t = 0; t < frames; ++t) {
    // Whole pixels: the first copy has come (2, 1) t px, the second has as far to go.
    const int left = frames - 1 - t;
    const cv::Mat first = still(middle - cv::Point(2 * t, t)),
                  second = still(middle + cv::Point(2 * left, left));
    cv::Mat blended;
    cv::addWeighted(first, 1 - t / (frames - 1.0), second, t / (frames - 1.0), 0, blended);
    EXPECT_LT(levels_apart(made[t](middle), blended), 0.6) << t;
  }
}

TEST(QualityRivals, AConstantFlowIsOneFieldOrMany) {
  const std::vector<cv::Mat> one{constant(0.8f, 0.3f)}, many(10, constant(0.8f, 0.3f));
  const auto a = carry_still(picture(), everywhere(), one, 11),
             b = carry_still(picture(), everywhere(), many, 11);
  for (int t = 0; t < 11; ++t) EXPECT_EQ(levels_apart(a[t], b[t]), 0);
}

TEST(QualityRivals, AVaryingFlowIsFollowedFrameByFrame) {
  std::vector<cv::Mat> flow;
  for (int t = 0; t < 8; ++t) flow.push_back(constant(t < 4 ? 2.0f : -2.0f, 0));
  const cv::Mat still = picture();
  const std::vector<cv::Mat> made = carry_still(still, everywhere(), flow, 9);
  const cv::Rect middle(40, 30, 80, 60);
  // After four frames right, 8 px; the way back is as long, so both copies agree.
  EXPECT_LT(levels_apart(made[4](middle), still(middle - cv::Point(8, 0))), 0.6);
}

TEST(QualityRivals, OutsideTheMatteIsTheStill) {
  cv::Mat matte = everywhere();
  matte(cv::Rect(0, 0, 80, 120)) = 0;
  const std::vector<cv::Mat> flow{constant(3, 0)};
  const std::vector<cv::Mat> made = carry_still(picture(), matte, flow, 10);
  const cv::Rect left(0, 0, 80, 120), right(100, 0, 60, 120);
  EXPECT_EQ(levels_apart(made[5](left), picture()(left)), 0);
  EXPECT_GT(levels_apart(made[5](right), picture()(right)), 5);
}

TEST(QualityRivals, WhatComesFromOutsideIsLeftToTheOtherCopy) {
  const int frames = 11;
  const std::vector<cv::Mat> flow{constant(4, 0)};
  const cv::Mat still = picture();
  const std::vector<cv::Mat> made = carry_still(still, everywhere(), flow, frames);
  // At frame 5, x < 20 would come from beyond the left edge: the second copy alone, which has 20 px to go.
  const cv::Rect edge(4, 20, 12, 80);
  EXPECT_LT(levels_apart(made[5](edge), still(edge + cv::Point(20, 0))), 0.6);
}

}  // namespace
}  // namespace freshet::bench
