#include "synth/animate/still/colour_range.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "synth/animate/still/colour_model.h"

namespace freshet::synth::animate {
namespace {

constexpr float kWhite = 1000;  // of the still's unit

cv::Vec3f coloured(float luma, float blue, float red) {
  return {luma + blue, luma - (kBlueLuma * blue + kRedLuma * red) / kGreenLuma, luma + red};
}

/// A green sea below .4, yellow sand from .6 on, and nothing between.
struct Shore {
  cv::Mat bgr, luma, matte;

  Shore() : bgr(40, 100, CV_32FC3), luma(40, 100, CV_32F), matte(40, 100, CV_32F, cv::Scalar(1)) {
    for (int y = 0; y < luma.rows; ++y)
      for (int x = 0; x < luma.cols; ++x) {
        const bool sand = x >= 50;
        const float l = sand ? 0.6f + 0.004f * static_cast<float>(x - 50) : 0.008f * static_cast<float>(x);
        luma.at<float>(y, x) = l;
        bgr.at<cv::Vec3f>(y, x) = sand ? coloured(l, -0.2f, 0.1f) : coloured(l, 0.05f, -0.1f);
      }
  }
  ColourRange range() const { return {bgr, luma, matte}; }
};

/// Blue and red less luma, limited at a place that has this colour in the still.
cv::Vec2f limited(const ColourRange& range, float luma, cv::Vec2f chroma, const cv::Vec3f& still) {
  std::array<std::uint16_t, 3> own{};
  for (int k = 0; k < 3; ++k)
    own[static_cast<std::size_t>(k)] = cv::saturate_cast<std::uint16_t>(kWhite * still[k]);
  range.limit(&luma, {&own[0], &own[1], &own[2]}, kWhite, 1, &chroma[0], &chroma[1]);
  return chroma;
}

TEST(ColourRange, WhatThePictureHasStaysAsItIs) {
  const Shore shore;
  const ColourRange range = shore.range();
  for (int x = 0; x < 100; ++x) {
    const float l = shore.luma.at<float>(0, x);
    const cv::Vec3f& own = shore.bgr.at<cv::Vec3f>(0, x);
    const cv::Vec2f chroma(own[0] - l, own[2] - l);
    EXPECT_EQ(limited(range, l, chroma, {0.5f, 0.5f, 0.5f}), chroma) << x;
  }
}

TEST(ColourRange, ASumOfTwoColoursIsNoThird) {
  const ColourRange range = Shore().range();
  const cv::Vec3f grey(0.5f, 0.5f, 0.5f);
  const cv::Vec2f orange = limited(range, 0.7f, {-0.45f, 0.3f}, grey);
  EXPECT_NEAR(orange[0], -0.2f, 1e-5);
  EXPECT_NEAR(orange[1], 0.1f, 1e-5);
  // Between the sea's luminances and the sand's both count; beyond black and white the ends do.
  EXPECT_NEAR(limited(range, 0.5f, {1, -1}, grey)[0], 0.05f, 1e-5);
  EXPECT_NEAR(limited(range, 0.5f, {-1, 1}, grey)[1], 0.1f, 1e-5);
  EXPECT_NEAR(limited(range, 2, {1, 1}, grey)[1], 0.1f, 1e-5);
  EXPECT_NEAR(limited(range, -1, {1, 1}, grey)[1], 0, 2e-3);
}

TEST(ColourRange, APlaceMayKeepItsOwnColour) {
  const ColourRange range = Shore().range();
  const cv::Vec2f own = limited(range, 0.2f, {-0.4f, 0.3f}, coloured(0.7f, -0.2f, 0.1f));
  EXPECT_NEAR(own[0], -0.2f, 2e-3);
  EXPECT_NEAR(own[1], 0.1f, 2e-3);
}

TEST(ColourRange, OnlyTheFluidCounts) {
  Shore shore;
  shore.matte.colRange(0, 50).setTo(0);
  const cv::Vec3f grey(0.5f, 0.5f, 0.5f);
  EXPECT_NEAR(limited(shore.range(), 0.1f, {1, -1}, grey)[0], 0, 1e-5);
  shore.matte.setTo(0);
  EXPECT_EQ(limited(shore.range(), 0.1f, {1, -1}, grey), cv::Vec2f(1, -1));
}

}  // namespace
}  // namespace freshet::synth::animate
