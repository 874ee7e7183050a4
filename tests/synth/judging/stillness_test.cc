#include "synth/judging/stillness.h"

#include <gtest/gtest.h>

#include "tests/synth/judging/made_film.h"

namespace freshet::synth::judging {
namespace {

TEST(JudgingStillness, WhatNeverChangesIsCounted) {
  EXPECT_LT(stillness(made_film()).value, 0.01);
  const cv::Mat first = made_film().frames().front();
  const Reading half =
      stillness(made_film([&](cv::Mat& frame, int) { first.colRange(0, 80).copyTo(frame.colRange(0, 80)); }));
  EXPECT_NEAR(half.value, 0.5, 0.02);
  EXPECT_FLOAT_EQ(half.map.front().at<float>(5, 3), 1);
  EXPECT_LT(half.map.front().at<float>(5, 12), 0.05F);
}

}  // namespace
}  // namespace freshet::synth::judging
