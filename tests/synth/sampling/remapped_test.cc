#include "synth/sampling/remapped.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::sampling {
namespace {

cv::Mat noise(cv::Size size, int type, double least, double most) {
  cv::Mat out(size, type);
  cv::RNG random(7);
  random.fill(out, cv::RNG::UNIFORM, cv::Scalar::all(least), cv::Scalar::all(most));
  return out;
}

TEST(Remapped, IsWhatOpenCvReadsInsideAndBeyond) {
  const cv::Mat places = noise({61, 37}, CV_32FC2, -6, 66);
  for (const int type : {CV_32FC1, CV_32FC2, CV_32FC4}) {
    const cv::Mat plane = noise({55, 43}, type, -1, 1);
    cv::Mat found, expected;
    read_remapped(plane, places, found);
    cv::remap(plane, expected, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    ASSERT_EQ(found.type(), type);
    EXPECT_LT(cv::norm(found, expected, cv::NORM_INF), 1e-6) << type;
  }
}

TEST(Remapped, RoundsHalvesToTheEvenStep) {
  cv::Mat ramp(1, 4, CV_32F), places(1, 2, CV_32FC2), found;
  for (int x = 0; x < 4; ++x) ramp.at<float>(x) = 32.0f * static_cast<float>(x);
  places.at<cv::Vec2f>(0) = {1 + 0.5f / 32, 0};
  places.at<cv::Vec2f>(1) = {1 + 1.5f / 32, 0};
  read_remapped(ramp, places, found);
  EXPECT_EQ(found.at<float>(0), 32);
  EXPECT_EQ(found.at<float>(1), 34);
}

TEST(Remapped, PlacesFarAwayAreEdges) {
  const cv::Mat ones(5, 5, CV_32F, cv::Scalar(1));
  cv::Mat places(1, 3, CV_32FC2), found;
  places.at<cv::Vec2f>(0) = {1e9f, 2};
  places.at<cv::Vec2f>(1) = {2, -1e9f};
  places.at<cv::Vec2f>(2) = {-40000, 40000};
  read_remapped(ones, places, found);
  EXPECT_EQ(cv::countNonZero(found == 1), 3);
}

TEST(Remapped, BeyondItsSidesAPlaneGoesOnMirrored) {
  cv::Mat row(1, 5, CV_32F), wide;
  for (int x = 0; x < 5; ++x) row.at<float>(x) = static_cast<float>(x);
  cv::copyMakeBorder(row, wide, 0, 0, 60, 60, cv::BORDER_REFLECT);
  for (int at = -60; at < 65; ++at)
    EXPECT_EQ(mirrored(static_cast<float>(at), 5), wide.at<float>(at + 60)) << at;
  for (const float away : {-1e30f, -71.3f, -0.5f, 4.5f, 71.3f, 1e30f}) {
    EXPECT_GE(mirrored(away, 5), -0.5f) << away;
    EXPECT_LE(mirrored(away, 5), 4.5f) << away;
  }
}

TEST(Remapped, WhatIsCarriedInFromBeyondASideComesWithoutItsRim) {
  for (const float at : {0.0f, 0.3f, 199.0f})
    EXPECT_NEAR(carried_from(at, at, 200), at, 1e-4) << "frame 0 is the still";
  EXPECT_FLOAT_EQ(carried_from(120, 100, 200), 120);
  // Carried by 20 samples over the right side: from 197.5 on, two of 200 short of it, the way goes back.
  EXPECT_FLOAT_EQ(carried_from(197, 177, 200), 197);
  EXPECT_FLOAT_EQ(carried_from(199, 179, 200), 196);
  EXPECT_FLOAT_EQ(carried_from(207, 187, 200), 188);
  EXPECT_FLOAT_EQ(carried_from(-7, 13, 200), 10);
}

}  // namespace
}  // namespace freshet::synth::sampling
