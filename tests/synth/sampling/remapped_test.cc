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
  constexpr Span kAlone{0, 100, 100};
  for (const float at : {0.0f, 0.3f, 99.0f})
    EXPECT_NEAR(carried_from(at, at, kAlone), at, 1e-4) << "frame 0 is the still";
  EXPECT_FLOAT_EQ(carried_from(60, 50, kAlone), 60);
  // Carried by 20 samples over the right side: from 97.5 on, two of 100 short of it, the way goes back.
  EXPECT_FLOAT_EQ(carried_from(97, 77, kAlone), 97);
  EXPECT_FLOAT_EQ(carried_from(99, 79, kAlone), 96);
  EXPECT_FLOAT_EQ(carried_from(107, 87, kAlone), 88);
  EXPECT_FLOAT_EQ(carried_from(-7, 13, kAlone), 10);
  EXPECT_FLOAT_EQ(beyond(97, 77, kAlone), 0);
  EXPECT_FLOAT_EQ(beyond(107, 87, kAlone), 9.5);
  EXPECT_FLOAT_EQ(beyond(-7, 13, kAlone), -8.5);
}

TEST(Remapped, WhatIsCarriedInFromBeyondASideIsWhatThePictureIsContinuedBy) {
  constexpr Span kPicture{30, 130, 150};
  EXPECT_FLOAT_EQ(carried_from(60, 50, kPicture), 60);
  // As far beyond the side as it is beyond the rim's inner end; what is continued ends, too.
  EXPECT_FLOAT_EQ(carried_from(23, 43, kPicture), 19);
  EXPECT_FLOAT_EQ(carried_from(133, 113, kPicture), 137);
  EXPECT_FLOAT_EQ(carried_from(149, 129, kPicture), 146);
}

}  // namespace
}  // namespace freshet::synth::sampling
