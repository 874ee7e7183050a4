#include "synth/animate/still/colour_curve.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "synth/animate/still/carried_base.h"
#include "synth/animate/still/colour_model.h"

namespace freshet::synth::animate {
namespace {

/// A flame's red less luma: rises from dark to orange, falls again to yellow.
float red_of(float luma) { return 0.4f * std::sin(3.1f * luma); }
float blue_of(float luma) { return -0.5f * luma; }

/// A picture with luminances from `least` to `most`, coloured so.
struct Fluid {
  cv::Mat bgr, luma, matte;

  Fluid(float least, float most) : bgr(60, 80, CV_32FC3), luma(60, 80, CV_32F), matte(60, 80, CV_32F, 1.0) {
    cv::RNG(5).fill(luma, cv::RNG::UNIFORM, least, most);
    for (int y = 0; y < luma.rows; ++y)
      for (int x = 0; x < luma.cols; ++x) {
        const float l = luma.at<float>(y, x), blue = blue_of(l), red = red_of(l),
                    green = -(kBlueLuma * blue + kRedLuma * red) / kGreenLuma;
        bgr.at<cv::Vec3f>(y, x) = {l + blue, l + green, l + red};
      }
  }
  ColourCurve curve() const { return {bgr, luma, matte}; }
};

/// Of blue and red, for one pixel.
cv::Vec2f change(const ColourCurve& curve, float from, float to) {
  const auto carried = static_cast<std::int16_t>(std::lround(from * CarriedFrame::kOne));
  cv::Vec2f out;
  curve.follow(&carried, &to, 1, &out[0], &out[1]);
  return out;
}

TEST(ColourCurve, FollowsThePictureFromDarkToBright) {
  const ColourCurve curve = Fluid(0, 1).curve();
  for (const float from : {0.1f, 0.35f, 0.8f})
    for (const float to : {0.15f, 0.5f, 0.9f}) {
      const cv::Vec2f got = change(curve, from, to);
      EXPECT_NEAR(got[0], blue_of(to) - blue_of(from), 0.03) << from << " " << to;
      EXPECT_NEAR(got[1], red_of(to) - red_of(from), 0.03) << from << " " << to;
    }
}

TEST(ColourCurve, WhatKeepsItsLuminanceKeepsItsColour) {
  const ColourCurve curve = Fluid(0, 1).curve();
  for (const float luma : {0.0f, 0.25f, 0.5f, 1.0f}) EXPECT_EQ(change(curve, luma, luma), cv::Vec2f());
}

TEST(ColourCurve, LuminancesThatTheFluidHasNotTakeTheNearestOnesColour) {
  const ColourCurve curve = Fluid(0.3f, 0.6f).curve();
  EXPECT_NEAR(change(curve, 0.45f, 0.99f)[0], blue_of(0.63f) - blue_of(0.45f), 0.04);
  EXPECT_EQ(change(curve, 0.95f, 2), cv::Vec2f());
  EXPECT_EQ(change(curve, 0.05f, -1), cv::Vec2f());
}

TEST(ColourCurve, OnlyTheFluidCounts) {
  Fluid fluid(0, 1);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 40; ++x) {
      fluid.bgr.at<cv::Vec3f>(y, x) = {1, 0, 0};
      fluid.matte.at<float>(y, x) = 0;
    }
  EXPECT_NEAR(change(fluid.curve(), 0.2f, 0.6f)[0], blue_of(0.6f) - blue_of(0.2f), 0.03);
  fluid.matte.setTo(0);
  EXPECT_EQ(change(fluid.curve(), 0.2f, 0.6f), cv::Vec2f());
}

}  // namespace
}  // namespace freshet::synth::animate
