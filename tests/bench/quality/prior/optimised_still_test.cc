#include "bench/quality/prior/optimised_still.h"

#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "tests/bench/quality/still_and_flow.h"

namespace freshet::bench {
namespace {

const cv::Size kSize(96, 80);

cv::Mat grain() {
  cv::Mat still = grain_of(kSize, 1.5);
  cv::normalize(still, still, 0, 255, cv::NORM_MINMAX);
  return still;
}
cv::Mat whole() { return all_of(kSize); }
cv::Mat steady(float u, float v) { return flow_of(kSize, u, v); }

TEST(OptimisedStill, WhereNothingFlowsItIsTheStill) {
  const std::vector<cv::Mat> made = optimise_still(grain(), whole(), steady(0, 0), 4);
  ASSERT_EQ(made.size(), 4u);
  for (const cv::Mat& frame : made) EXPECT_LT(levels_apart(frame, grain()), 0.1);
}

TEST(OptimisedStill, TextureGoesWhereItIsAsked) {
  const std::vector<cv::Mat> made = optimise_still(grain(), whole(), steady(2, 1), 6);
  EXPECT_EQ(levels_apart(made[0], grain()), 0);
  // Away from the edges, where fluid comes in that the still does not show.
  const cv::Rect middle(24, 20, 56, 48);
  // A still frame would be 34 grey levels away.
  for (int t = 1; t < 6; ++t)
    EXPECT_LT(levels_apart(made[t](middle), grain()(middle - cv::Point(2 * t, t))), 14) << t;
}

TEST(OptimisedStill, WhatGoesLessThanAPixelAFrameGoesToo) {
  const std::vector<cv::Mat> made = optimise_still(grain(), whole(), steady(0.25f, 0), 21);
  ASSERT_EQ(made.size(), 21u);
  const cv::Rect middle(24, 20, 56, 48);
  for (const int t : {4, 8, 12, 20})
    EXPECT_LT(levels_apart(made[t](middle), grain()(middle - cv::Point(t / 4, 0))), 5) << t;
}

TEST(OptimisedStill, WhatComesInIsMadeOfTheStillsPatches) {
  const std::vector<cv::Mat> made = optimise_still(grain(), whole(), steady(4, 0), 6);
  cv::Scalar mean, deviation, mean_of_still, deviation_of_still;
  cv::meanStdDev(made[5](cv::Rect(0, 0, 20, 80)), mean, deviation);
  cv::meanStdDev(grain(), mean_of_still, deviation_of_still);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean[c], mean_of_still[c], 12);
    EXPECT_GT(deviation[c], 0.4 * deviation_of_still[c]);
  }
}

TEST(OptimisedStill, OutsideTheMatteIsTheStill) {
  cv::Mat matte = whole();
  matte(cv::Rect(0, 0, 40, 80)) = 0;
  const std::vector<cv::Mat> made = optimise_still(grain(), matte, steady(2, 0), 4);
  const cv::Rect left(0, 0, 40, 80), right(56, 0, 40, 80);
  EXPECT_EQ(levels_apart(made[3](left), grain()(left)), 0);
  EXPECT_GT(levels_apart(made[3](right), grain()(right)), 5);
}

TEST(OptimisedStill, ThreadsChangeNothing) {
  const auto last = [] { return optimise_still(grain(), whole(), steady(1.3f, -0.6f), 3).back(); };
  const cv::Mat all = last();
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(levels_apart(all, last()), 0);
}

TEST(OptimisedStill, ABlackMatteIsRefused) {
  EXPECT_THROW(optimise_still(grain(), cv::Mat::zeros(kSize, CV_8U), steady(1, 0), 2), Error);
}

}  // namespace
}  // namespace freshet::bench
