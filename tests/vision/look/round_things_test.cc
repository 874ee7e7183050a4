#include "vision/look/round_things.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "vision/look/standing.h"

namespace freshet::vision {
namespace {

const cv::Size kSky(640, 480);

/// A sky of soft streaks, to draw on.
cv::Mat sky() {
  cv::Mat streaks(kSky, CV_8UC3);
  cv::RNG(1).fill(streaks, cv::RNG::UNIFORM, 0, 60);
  cv::GaussianBlur(streaks, streaks, {}, 4, 1);
  return streaks + cv::Scalar(130, 90, 60);
}

const cv::Mat kAll(kSky, CV_8U, cv::Scalar(255));
const cv::Scalar kYellow(90, 200, 230);

cv::Mat found_in(const cv::Mat& picture) { return round_things(picture, kAll) > 127; }

double share(const cv::Mat& part, const cv::Mat& where) {
  return static_cast<double>(cv::countNonZero(part & where)) / cv::countNonZero(where);
}

TEST(RoundThings, AStarIsFoundAndHeldAndTheSkyLeft) {
  cv::Mat picture = sky(), star = cv::Mat::zeros(kSky, CV_8U);
  EXPECT_EQ(cv::countNonZero(found_in(picture)), 0);
  cv::circle(star, {400, 200}, 20, 255, cv::FILLED);
  picture.setTo(kYellow, star);
  EXPECT_GT(share(found_in(picture), star), .85);
  EXPECT_LT(share(found_in(picture), ~star), .002);
  EXPECT_GT(share(what_stands(picture, kAll) > 127, star), .85);
  cv::Mat beside = kAll.clone();
  beside(cv::Rect(300, 100, 200, 200)).setTo(0);
  EXPECT_EQ(cv::countNonZero(what_stands(picture, beside) & star), 0) << "it is not in the matte";
}

TEST(RoundThings, WhatIsLongBentFaintOrTooLargeOrSmallIsNone) {
  cv::Mat bar = sky(), ring = sky(), faint = sky(), large = sky(), small = sky();
  cv::rectangle(bar, {300, 200}, {420, 220}, kYellow, cv::FILLED);
  EXPECT_EQ(cv::countNonZero(found_in(bar)), 0);
  cv::ellipse(ring, {320, 240}, {40, 40}, 0, 0, 300, kYellow, 8);
  EXPECT_EQ(cv::countNonZero(found_in(ring)), 0);
  faint(cv::Rect(300, 200, 40, 40)) += cv::Scalar(10, 10, 10);
  EXPECT_EQ(cv::countNonZero(found_in(faint)), 0);
  cv::circle(large, {320, 240}, 110, kYellow, cv::FILLED);
  EXPECT_EQ(cv::countNonZero(found_in(large)), 0);
  cv::circle(small, {320, 240}, 5, kYellow, cv::FILLED);
  EXPECT_EQ(cv::countNonZero(found_in(small)), 0);
}

TEST(RoundThings, OfAFluidOfManyColoursNoneIsUnlikeIt) {
  cv::Mat picture = sky();
  for (int y = 0; y < kSky.height; y += 60) picture.rowRange(y, y + 30).setTo(kYellow);
  cv::circle(picture, {320, 105}, 12, kYellow, cv::FILLED);
  EXPECT_EQ(cv::countNonZero(found_in(picture)), 0);
}

TEST(RoundThings, LargerPicturesAreWorkedSmallAndOfAPixelNothingBreaks) {
  cv::Mat picture = sky(), large;
  cv::circle(picture, {400, 200}, 20, kYellow, cv::FILLED);
  cv::resize(picture, large, {}, 3, 3, cv::INTER_LINEAR);
  const cv::Mat found = round_things(large, cv::Mat(large.size(), CV_8U, cv::Scalar(255)));
  ASSERT_EQ(found.size(), large.size());
  EXPECT_GT(found.at<uchar>(600, 1200), 250);
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 50), cv::Size(50, 1)})
    EXPECT_EQ(cv::countNonZero(round_things(cv::Mat(size, CV_8UC3, cv::Scalar(9, 90, 190)),
                                            cv::Mat(size, CV_8U, cv::Scalar(255)))),
              0);
}

}  // namespace
}  // namespace freshet::vision
