#include "vision/look/lies_at.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace freshet::vision {
namespace {

const cv::Size kPond(320, 240);
const cv::Point kLily(100, 120), kFar(240, 60);
constexpr int kRadius = 18;

/// Rippled water between banks above and below, a dark lily in it.
struct Pond {
  cv::Mat picture{kPond, CV_8UC3, cv::Scalar(60, 90, 80)};
  cv::Mat matte = cv::Mat::zeros(kPond, CV_8U), nothing = matte.clone(), lily = matte.clone();

  Pond() {
    matte.rowRange(20, 220).setTo(255);
    cv::circle(lily, kLily, kRadius, 255, cv::FILLED);
    cv::Mat ripples(kPond, CV_8UC3);
    cv::RNG(1).fill(ripples, cv::RNG::UNIFORM, 0, 40);
    cv::GaussianBlur(ripples, ripples, {}, 1.5);
    ripples += cv::Scalar(150, 120, 90);
    ripples.copyTo(picture, matte);
    picture.setTo(cv::Scalar(50, 110, 60), lily);
  }
  double takes() const { return static_cast<double>(cv::countNonZero(lily)) / cv::countNonZero(matte); }
};

double share(const cv::Mat& part, const cv::Mat& where) {
  return static_cast<double>(cv::countNonZero(part & where)) / cv::countNonZero(where);
}

TEST(LiesAt, AClickInAThingTakesItUpToItsEdgeAtEachSize) {
  const Pond pond;
  for (const double scale : {1., 3.}) {
    cv::Mat picture, matte, lily;
    cv::resize(pond.picture, picture, {}, scale, scale, cv::INTER_LINEAR);
    cv::resize(pond.matte, matte, picture.size(), 0, 0, cv::INTER_NEAREST);
    cv::resize(pond.lily, lily, picture.size(), 0, 0, cv::INTER_NEAREST);
    // Nowhere near its middle: what is alike is nearer than what is close.
    const cv::Point at = (kLily + cv::Point(8, -6)) * scale;
    const cv::Mat found =
        what_lies_at(picture, matte, cv::Mat::zeros(matte.size(), CV_8U), at, {}, 1.2 * pond.takes());
    ASSERT_EQ(found.size(), picture.size());
    EXPECT_GT(share(found, lily), .9) << scale;
    EXPECT_LT(share(found, ~lily), .01) << scale;
    EXPECT_EQ(cv::countNonZero(found & ~matte), 0) << scale;
  }
}

TEST(LiesAt, OfWaterAClickTakesItsShare) {
  const Pond pond;
  EXPECT_NEAR(share(what_lies_at(pond.picture, pond.matte, pond.nothing, kFar, {}), pond.matte), kClickTakes,
              .003);
  EXPECT_NEAR(share(what_lies_at(pond.picture, pond.matte, pond.nothing, kFar, {}, .1), pond.matte), .1,
              .005);
}

TEST(LiesAt, OfEvenWaterAClickTakesADisc) {
  const cv::Mat even(kPond, CV_8UC3, cv::Scalar(150, 120, 90)), all(kPond, CV_8U, cv::Scalar(255)),
      found = what_lies_at(even, all, all & 0, kFar, {}, .05);
  double farthest = 0;
  for (int y = 0; y < found.rows; ++y)
    for (int x = 0; x < found.cols; ++x)
      if (found.at<uchar>(y, x) != 0) farthest = std::max(farthest, cv::norm(cv::Point(x, y) - kFar));
  EXPECT_GT(cv::countNonZero(found), .85 * CV_PI * farthest * farthest);
}

TEST(LiesAt, OfWhatIsAsFarFromTheClicksColourTheSmoothIsTakenAndEdgesStayBeyond) {
  cv::Mat picture(kPond, CV_8UC3, cv::Scalar(150, 120, 90));
  const cv::Rect smooth(100, 100, 40, 40), striped(160, 100, 40, 40);
  picture(smooth) += cv::Scalar(20, 20, 20);
  for (int x = striped.x; x < striped.x + striped.width; ++x)
    picture(cv::Rect(x, striped.y, 1, striped.height)) += (x % 6 < 3 ? 1 : -1) * cv::Scalar(20, 20, 20);
  const cv::Mat all(kPond, CV_8U, cv::Scalar(255)),
      found = what_lies_at(picture, all, all & 0, {150, 120}, {}, .04);
  EXPECT_GT(cv::countNonZero(found(smooth)), 1.1 * cv::countNonZero(found(striped)));
}

TEST(LiesAt, WhatIsNearerToAClickOfTheOtherKindIsLeft) {
  const Pond pond;
  const cv::Point other = kLily - cv::Point(9, 0), at = kLily + cv::Point(9, 0);
  const std::vector others{other};
  const cv::Mat all = what_lies_at(pond.picture, pond.matte, pond.nothing, at, {}, pond.takes()),
                found = what_lies_at(pond.picture, pond.matte, pond.nothing, at, others, pond.takes());
  EXPECT_NE(all.at<uchar>(other), 0);
  EXPECT_EQ(found.at<uchar>(other), 0);
  EXPECT_NE(found.at<uchar>(at), 0);
  EXPECT_NEAR(share(found, pond.lily), .5, .2);
}

TEST(LiesAt, AClickOnWhatIsHeldTakesOfThatAlone) {
  const Pond pond;
  cv::Mat held = pond.lily.clone();
  held.colRange(0, kLily.x + 40).rowRange(kLily.y - 5, kLily.y + 5).setTo(255);
  const cv::Mat found = what_lies_at(pond.picture, pond.matte, held, kLily + cv::Point(30, 0), {});
  EXPECT_GT(cv::countNonZero(found), 0);
  EXPECT_EQ(cv::countNonZero(found & ~held), 0);
  EXPECT_EQ(cv::countNonZero(what_lies_at(pond.picture, pond.matte, held, kFar, {}, .5) & held), 0);
}

TEST(LiesAt, OfColoursAsFarFromTheClicksTheOneThatLiesBesideTheFluidIsTaken) {
  const cv::Scalar blue(150, 110, 100), brown(90, 110, 120);
  const cv::Rect stone(60, 100, 40, 30), between(100, 100, 20, 30);
  int taken = 0, beyond = 0;
  for (const auto& [bank, water] : {std::pair(blue, brown), std::pair(brown, blue)}) {
    Pond pond;
    pond.picture.setTo(bank);
    pond.picture.setTo(water, pond.matte);
    pond.picture(stone).setTo(bank);
    pond.picture(between).setTo((bank + water) / 2);
    const double takes = static_cast<double>(stone.area() + between.area()) / cv::countNonZero(pond.matte);
    const cv::Mat found = what_lies_at(pond.picture, pond.matte, pond.nothing, {110, 115}, {}, takes);
    taken += cv::countNonZero(found(stone));
    beyond += cv::countNonZero(found(stone + cv::Point(60, 0)));
  }
  EXPECT_GT(taken, 1.3 * beyond);
}

TEST(LiesAt, TheRimOfAnIslandIsTakenAllAroundAndTheWaterBeyondItLeft) {
  Pond pond;
  cv::Mat rim = pond.lily.clone(), island = cv::Mat::zeros(kPond, CV_8U);
  cv::circle(island, kLily, kRadius - 4, 255, cv::FILLED);
  rim.setTo(0, island);
  pond.matte.setTo(0, island);  // the matte misses it by a rim of 4 px
  const double takes = static_cast<double>(cv::countNonZero(rim)) / cv::countNonZero(pond.matte);
  const cv::Mat found =
      what_lies_at(pond.picture, pond.matte, pond.nothing, kLily + cv::Point(0, kRadius - 2), {}, takes);
  EXPECT_GT(share(found, rim), .8);
  EXPECT_LT(share(found, ~rim), .01);
}

TEST(LiesAt, ARingAroundTheWaterIsNotFilled) {
  Pond pond;
  const cv::Rect water(120, 90, 80, 60);
  pond.picture.setTo(cv::Scalar(50, 110, 60));
  pond.picture(water).setTo(cv::Scalar(170, 140, 110));
  pond.matte.setTo(0);
  pond.matte(water + cv::Size(8, 8) - cv::Point(4, 4)).setTo(255);
  const double takes = 1 - static_cast<double>(water.area()) / cv::countNonZero(pond.matte);
  const cv::Mat found = what_lies_at(pond.picture, pond.matte, pond.nothing, {160, 88}, {}, 1.2 * takes);
  EXPECT_NE(found.at<uchar>(152, 160), 0);
  EXPECT_EQ(found.at<uchar>(120, 160), 0);
}

TEST(LiesAt, BesideTheMatteNothingLiesAndInAPixelNothingBreaks) {
  const Pond pond;
  EXPECT_EQ(cv::countNonZero(what_lies_at(pond.picture, pond.matte, pond.nothing, {5, 5}, {})), 0);
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 50), cv::Size(50, 1)}) {
    const cv::Mat picture(size, CV_8UC3, cv::Scalar(9, 90, 190)), whole(size, CV_8U, cv::Scalar(255));
    EXPECT_GT(cv::countNonZero(what_lies_at(picture, whole, cv::Mat::zeros(size, CV_8U), {0, 0}, {})), 0);
  }
}

TEST(LiesAt, TheInnermostPointIsFarthestFromTheOutside) {
  cv::Mat area = cv::Mat::zeros(kPond, CV_8U);
  cv::circle(area, kFar, 20, 255, cv::FILLED);
  area.row(200).setTo(255);
  EXPECT_LE(cv::norm(innermost(area) - kFar), 1.5);
  area.setTo(255);  // the picture's sides are an outside
  EXPECT_NEAR(innermost(area).y, kPond.height / 2, 2);
  EXPECT_NEAR(innermost(area(cv::Rect(0, 0, 40, 40))).y, 20, 1) << "what lies beside a part is not of it";
}

}  // namespace
}  // namespace freshet::vision
