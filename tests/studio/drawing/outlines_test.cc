#include "studio/drawing/outlines.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace freshet::studio {
namespace {

cv::Mat drawn(const std::vector<std::vector<cv::Point>>& outlines, cv::Size size) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8U);
  for (const std::vector<cv::Point>& outline : outlines) cv::fillPoly(mask, outline, 255);
  return mask;
}

TEST(Outlines, WhatIsDrawnAgainIsTheMaskWithItsHoles) {
  cv::Mat mask = cv::Mat::zeros(120, 200, CV_8U);
  cv::rectangle(mask, {10, 10}, {110, 110}, 255, cv::FILLED);
  cv::circle(mask, {40, 40}, 15, 0, cv::FILLED);
  cv::rectangle(mask, {70, 60}, {100, 100}, 0, cv::FILLED);
  cv::circle(mask, {85, 80}, 8, 255, cv::FILLED);  // an island in a hole
  cv::circle(mask, {160, 60}, 25, 255, cv::FILLED);
  const auto outlines = outlines_of(mask, 4);
  ASSERT_EQ(outlines.size(), 3U);
  EXPECT_GT(outlines[0].size(), 12U) << "cut to both holes";
  EXPECT_LT(cv::countNonZero(drawn(outlines, mask.size()) ^ mask), 120);
}

TEST(Outlines, SmallAreasAndHolesAreLeftOut) {
  cv::Mat mask = cv::Mat::zeros(100, 100, CV_8U);
  cv::rectangle(mask, {10, 10}, {60, 60}, 255, cv::FILLED);
  cv::rectangle(mask, {30, 30}, {34, 34}, 0, cv::FILLED);
  cv::rectangle(mask, {80, 80}, {84, 84}, 255, cv::FILLED);
  const auto outlines = outlines_of(mask, 60);
  ASSERT_EQ(outlines.size(), 1U);
  EXPECT_EQ(outlines[0].size(), 4U);
  EXPECT_TRUE(outlines_of(cv::Mat::zeros(9, 9, CV_8U), 0).empty());
}

TEST(Outlines, PointsAreTheMiddlesOfPixelsOfTheWholePicture) {
  EXPECT_EQ(outlines_json({{{0, 0}, {3, 1}}}, 2).dump(), "[[1.0,1.0,7.0,3.0]]");
}

}  // namespace
}  // namespace freshet::studio
