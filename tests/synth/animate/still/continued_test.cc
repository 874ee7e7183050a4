#include "synth/animate/still/continued.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {
namespace {

constexpr int kWide = 160, kHigh = 112;

/// A picture that repeats itself every 24 px across and every 28 px down, anywhere in the plane.
double repeated(double x, double y) {
  const double a = 2 * std::numbers::pi * x / 24, b = 2 * std::numbers::pi * y / 28;
  return 0.5 + 0.15 * std::sin(a) + 0.1 * std::sin(2 * a + b) + 0.1 * std::cos(b);
}

FluidPlanes planes_of(const cv::Mat& luma, const cv::Mat& matte) {
  cv::Mat bgr;
  cv::merge(std::vector<cv::Mat>{0.9 * luma, luma, 0.5 * luma}, bgr);
  return fluid_planes(bgr, luma, matte);
}

cv::Mat luma_of_plane(const cv::Rect& at) {
  cv::Mat luma(at.size(), CV_32F);
  for (int y = 0; y < at.height; ++y)
    for (int x = 0; x < at.width; ++x)
      luma.at<float>(y, x) = static_cast<float>(repeated(at.x + x, at.y + y));
  return luma;
}

const cv::Rect kPicture(0, 0, kWide, kHigh);
cv::Mat all_fluid() { return cv::Mat(kPicture.size(), CV_32F, cv::Scalar(1)); }

TEST(Continued, APictureThatRepeatsGoesOnAsItIs) {
  const FluidPlanes planes = planes_of(luma_of_plane(kPicture), all_fluid());
  constexpr int kBy = 40, kJoined = 18;  // px next to the side, mirrored or blended
  struct Side {
    Sides by;
    cv::Rect added,
        rims;  // in the plane; by how much what is added lies too far away: the rims of both sides
  };
  const int x = 2 * (kWide / 50), y = 2 * (kHigh / 50);
  for (const Side& side : {Side{{.left = kBy}, {-kBy, 0, kBy - kJoined, kHigh}, {x, 0, 0, 0}},
                           Side{{.right = kBy}, {kWide + kJoined, 0, kBy - kJoined, kHigh}, {-x, 0, 0, 0}},
                           Side{{.top = kBy - 16}, {0, 16 - kBy, kWide, 8}, {0, y, 0, 0}}}) {
    const ContinuedFluid fluid = continued(planes, all_fluid(), side.by);
    ASSERT_EQ(fluid.planes.luma.cols, kWide + side.by.left + side.by.right);
    ASSERT_EQ(fluid.planes.luma.rows, kHigh + side.by.top);
    EXPECT_EQ(cv::norm(fluid.planes.luma(fluid.picture), planes.luma, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(fluid.matte, cv::Mat::ones(fluid.matte.size(), CV_32F), cv::NORM_INF), 0);
    const cv::Mat found = fluid.planes.luma(side.added + fluid.picture.tl());
    const auto away = [&](cv::Point by) {
      return cv::norm(found, luma_of_plane(side.added + side.rims.tl() + by), cv::NORM_L1) /
             static_cast<double>(found.total());
    };
    // Of a contrast of .2; the light is that of the side.
    EXPECT_LT(away({}), 0.07) << side.added;
    for (const cv::Point by : {cv::Point(2, 0), cv::Point(-2, 0), cv::Point(0, 2), cv::Point(0, -2)})
      EXPECT_LT(away({}), away(by)) << side.added << by;
  }
}

/// Clouds of many sizes.
cv::Mat clouds() {
  cv::Mat sum = cv::Mat::zeros(kPicture.size(), CV_32F), noise(kPicture.size(), CV_32F);
  cv::RNG random(7);
  for (const double sigma : {2.0, 5.0, 12.0}) {
    random.fill(noise, cv::RNG::NORMAL, 0, 1);
    cv::GaussianBlur(noise, noise, {}, sigma);
    sum += 0.15 * sigma * noise;
  }
  return 0.5 + sum;
}

TEST(Continued, WhatIsAddedIsNoMirroredTwinAndJoins) {
  const cv::Mat luma = clouds();
  const ContinuedFluid fluid = continued(planes_of(luma, all_fluid()), all_fluid(), {.right = 40});
  const int rim = kWide / 50;
  const cv::Mat added = fluid.planes.luma.colRange(kWide + rim + 8, kWide + 40);
  cv::Mat mirrored, match;
  cv::flip(luma.colRange(kWide - 40, kWide - rim - 8), mirrored, 1);
  cv::matchTemplate(added, mirrored, match, cv::TM_CCOEFF_NORMED);
  EXPECT_LT(match.at<float>(0), 0.8) << "alone it is 1";

  // Down each column, the mean step to the next one.
  cv::Mat own = luma.colRange(0, kWide - rim).clone(), joined;
  cv::hconcat(own, fluid.planes.luma.colRange(kWide + rim, kWide + 40), joined);
  const auto step = [&](int x) { return cv::norm(joined.col(x), joined.col(x + 1), cv::NORM_L1) / kHigh; };
  double usual = 0, most = 0;
  for (int x = 0; x + 1 < own.cols; ++x) usual += step(x) / (own.cols - 1);
  for (int x = own.cols - 1; x + 1 < joined.cols; ++x) most = std::max(most, step(x));
  EXPECT_LT(most, 2 * usual);
}

/// What comes in over a side that has hardly been carried: a thin strip, which must not be a strip of another place.
TEST(Continued, NextToTheSidesTheRimIsMirrored) {
  const FluidPlanes planes = planes_of(clouds(), all_fluid());
  const ContinuedFluid fluid =
      continued(planes, all_fluid(), {.left = 40, .right = 40, .top = 24, .bottom = 24});
  const cv::Rect in = fluid.picture;
  const cv::Mat own = fluid.planes.luma(in), across = fluid.planes.luma.rowRange(in.y, in.br().y),
                down = fluid.planes.luma.colRange(in.x, in.br().x);
  for (int i = 0; i < kWide / 50; ++i) {
    EXPECT_EQ(cv::norm(across.col(in.x - 1 - i), own.col(i), cv::NORM_INF), 0) << i;
    EXPECT_EQ(cv::norm(across.col(in.br().x + i), own.col(kWide - 1 - i), cv::NORM_INF), 0) << i;
  }
  for (int i = 0; i < kHigh / 50; ++i) {
    EXPECT_EQ(cv::norm(down.row(in.y - 1 - i), own.row(i), cv::NORM_INF), 0) << i;
    EXPECT_EQ(cv::norm(down.row(in.br().y + i), own.row(kHigh - 1 - i), cv::NORM_INF), 0) << i;
  }
}

TEST(Continued, FluidGoesOnAsFluid) {
  // A tree stands in a sky, away from its right side; below lies land.
  cv::Mat matte = all_fluid();
  matte.rowRange(90, kHigh) = 0;
  matte(cv::Rect(20, 20, 20, 70)) = 0;
  const ContinuedFluid fluid = continued(planes_of(clouds(), matte), matte, {.right = 40});
  const cv::Mat added = fluid.matte.colRange(kWide, kWide + 40);
  EXPECT_GT(cv::mean(added.rowRange(0, 80))[0], 0.95);
  EXPECT_LT(cv::mean(added.rowRange(105, kHigh))[0], 0.05);
}

TEST(Continued, SidesAreThoseThatTheFluidCrosses) {
  const auto sides = [](double u, double v, const cv::Mat& matte) {
    return crossed_sides(cv::Mat(kPicture.size(), CV_32FC2, cv::Scalar(u, v)), matte, 4);
  };
  const Sides right = sides(10, 0, all_fluid());
  EXPECT_EQ(right.left, 40);
  EXPECT_EQ(right.right, 40);
  EXPECT_EQ(right.top, 0);
  EXPECT_EQ(right.bottom, 0);
  const Sides still = sides(0, 0, all_fluid());
  EXPECT_EQ(still.left + still.right + still.top + still.bottom, 0);
  cv::Mat sky = all_fluid();
  sky.rowRange(60, kHigh) = 0;
  const Sides up = sides(0, -5, sky);
  EXPECT_EQ(up.top, 24);
  EXPECT_EQ(up.bottom, 0) << "no fluid lies there";
}

}  // namespace
}  // namespace freshet::synth::animate
