#include "synth/animate/still/standing_layout.h"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "synth/animate/still/lost_contrast.h"

namespace freshet::synth::animate {
namespace {

constexpr int kWidth = 256, kHeight = 192, kStep = 4, kLevels = 4;
const cv::Size kSamples(kWidth / kStep, kHeight / kStep);

/// Texture of these deviations in the left and in the right half.
cv::Mat texture(double left, double right) {
  cv::Mat luma(kHeight, kWidth, CV_32F);
  cv::RNG random(7);
  random.fill(luma, cv::RNG::NORMAL, 0, 1);
  cv::GaussianBlur(luma, luma, {}, 1.5);
  luma *= 5;
  luma.colRange(0, kWidth / 2) *= left;
  luma.colRange(kWidth / 2, kWidth) *= right;
  return luma + 0.5;
}

/// Fluid goes this way everywhere, and so far while a copy shows.
LayoutMotion going(float u, float v, double travel = 200) {
  return {cv::Mat(kSamples, CV_32FC2, cv::Scalar(u, v)), cv::Mat(kSamples, CV_32F, cv::Scalar(travel))};
}

StandingLayout layout_of(const cv::Mat& luma, const LayoutMotion& motion, double share = 0.2) {
  const cv::Mat matte(luma.size(), CV_32F, cv::Scalar(1));
  const FluidPlanes planes{luma, luma * 0, luma * 0, matte};
  return {planes, matte, motion, std::vector<double>(kLevels, share)};
}

double deviation(const cv::Mat& luma, const cv::Rect& where) {
  cv::Scalar mean, found;
  cv::meanStdDev(luma(where), mean, found);
  return found[0];
}
const cv::Rect kLeft(16, 16, 96, 160), kRight(144, 16, 96, 160);

/// What one copy that brings this of the texture shows over the layout.
cv::Mat laid(cv::Mat brought, const StandingLayout& layout) {
  const std::vector<CopyMap> copy{
      {cv::Mat(kSamples, CV_32F, cv::Scalar(1)), cv::Mat(kSamples, CV_32FC2, cv::Scalar(80, 0))}};
  lay_texture(brought, copy, kStep, {}, {}, layout, {});
  return brought;
}

TEST(StandingLayout, ItsTextureIsAsStrongEverywhere) {
  const StandingLayout layout = layout_of(texture(0.02, 0.1), going(0, 1));
  EXPECT_NEAR(deviation(layout.texture(), kLeft) / deviation(layout.texture(), kRight), 1, 0.2);
}

TEST(StandingLayout, TextureTakesTheMagnitudeOfThePlaceWhereItArrives) {
  const cv::Mat luma = texture(0.02, 0.1);
  const StandingLayout layout = layout_of(luma, going(0, 1));
  cv::Mat turned;
  cv::flip(layout.texture(), turned, 1);
  const cv::Mat frame = laid(turned, layout);
  EXPECT_NEAR(deviation(frame, kLeft) / deviation(luma, kLeft), 1, 0.2);
  EXPECT_NEAR(deviation(frame, kRight) / deviation(luma, kRight), 1, 0.2);
}

TEST(StandingLayout, WithItsOwnTextureItIsNearlyTheStill) {
  const cv::Mat luma = texture(0.06, 0.06);
  const StandingLayout layout = layout_of(luma, going(0, 1));
  const cv::Mat away = laid(layout.texture().clone(), layout) - luma;
  EXPECT_LT(deviation(away, {16, 16, 224, 160}), 0.35 * deviation(luma, {16, 16, 224, 160}));
}

TEST(StandingLayout, AnEdgeAcrossTheFlowStandsAndOneAlongItDoesNot) {
  cv::Mat brink = texture(0.01, 0.01);
  brink.rowRange(0, kHeight / 2) -= 0.3;
  const cv::Rect there(8, kHeight / 2 / kStep - 1, 48, 2);
  EXPECT_GT(cv::mean(layout_of(brink, going(0, 1)).edges()(there))[0], 0.95);
  EXPECT_LT(cv::mean(layout_of(brink, going(1, 0)).edges()(there))[0], 0.2);
}

TEST(StandingLayout, ABrinkIsNotInTheTexture) {
  const cv::Mat plain = texture(0.01, 0.01);
  cv::Mat brink = plain.clone();
  brink.rowRange(0, kHeight / 2) -= 0.3;
  const StandingLayout layout = layout_of(brink, going(0, 1));
  // Texture from beside the brink, laid over it: the brink stays where it is, and there is but one.
  cv::Mat moved = cv::Mat::zeros(brink.size(), CV_32F);
  layout.texture().rowRange(0, kHeight - 40).copyTo(moved.rowRange(40, kHeight));
  const cv::Mat frame = laid(moved, layout);
  const auto step = [](const cv::Mat& luma, int y) {
    return cv::mean(luma.rowRange(y + 4, y + 12))[0] - cv::mean(luma.rowRange(y - 12, y - 4))[0];
  };
  EXPECT_NEAR(step(frame, kHeight / 2), 0.3, 0.04);
  EXPECT_NEAR(step(frame, kHeight / 2 + 40), 0, 0.04);
}

TEST(StandingLayout, WhatTheFluidDoesNotLeaveStands) {
  const cv::Mat luma = texture(0.06, 0.06);
  const StandingLayout still = layout_of(luma, going(0, 1, 0)), fast = layout_of(luma, going(0, 1));
  EXPECT_LT(deviation(still.texture(), kLeft), 0.02 * deviation(fast.texture(), kLeft));
  const cv::Mat frame = laid(cv::Mat::zeros(luma.size(), CV_32F), still);
  EXPECT_LT(cv::norm(frame, luma, cv::NORM_INF), 1e-4);
}

TEST(StandingLayout, TheMoreStandsTheLessGoes) {
  const cv::Mat luma = texture(0.06, 0.06), none = cv::Mat::zeros(luma.size(), CV_32F);
  double before = 0;
  for (const double share : {0.05, 0.3, 0.6, 0.9}) {
    const double stands = deviation(laid(none.clone(), layout_of(luma, going(0, 1), share)), kLeft);
    EXPECT_GT(stands, before) << share;
    before = stands;
  }
}

}  // namespace
}  // namespace freshet::synth::animate
