#include "synth/animate/forms/parted_still.h"

#include <gtest/gtest.h>

#include "synth/animate/forms/light_level.h"
#include "tests/synth/animate/forms/burning.h"

namespace freshet::synth::animate {
namespace {

const cv::Mat kAll(160, 200, CV_32F, cv::Scalar(1));

TEST(PartedStill, GroundAndLightMakeThePicture) {
  const cv::Mat picture = BurningPicture{}.units();
  const PartedStill parted = part(picture, kAll);
  EXPECT_LT(cv::norm(parted.ground + parted.light, light_of(picture), cv::NORM_INF), 1e-5);
  EXPECT_GT(parted.contrast, 0.3);
}

TEST(PartedStill, TheGroundGoesOnBelowTheFlames) {
  const BurningPicture fire;
  const PartedStill parted = part(fire.units(), kAll);
  const cv::Vec3f below = parted.ground.at<cv::Vec3f>(fire.bed.y - 20, fire.bed.x),
                  dark = parted.ground.at<cv::Vec3f>(10, 10);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(level_of(below[k]), level_of(dark[k]), 0.03);
  EXPECT_GT(parted.level.at<float>(fire.bed.y - 20, fire.bed.x), 0.5);
  EXPECT_EQ(parted.level.at<float>(10, 10), 0);
}

TEST(PartedStill, TheGroundIsNoLighterThanThePicture) {
  const BurningPicture fire;
  cv::Mat picture = fire.units();
  // A light wall around a fire that has a dark gap.
  picture.rowRange(0, 40).setTo(cv::Scalar(0.6, 0.6, 0.6));
  picture(cv::Rect(105, 80, 10, 12)).setTo(cv::Scalar(0.02, 0.02, 0.03));
  const PartedStill parted = part(picture, kAll);
  cv::Mat luma;
  cv::transform(parted.light, luma, cv::Matx13f(0.114f, 0.587f, 0.299f));
  double least = 0;
  cv::minMaxLoc(luma, &least, nullptr);
  EXPECT_GT(least, -1e-5);
}

TEST(PartedStill, NothingShinesOutsideOfTheMatte) {
  const BurningPicture fire;
  cv::Mat alpha = kAll.clone();
  alpha.rowRange(0, 90).setTo(0);
  const PartedStill parted = part(fire.units(), alpha);
  EXPECT_EQ(cv::norm(parted.light.rowRange(0, 90), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(parted.level.rowRange(0, 90), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(parted.level, cv::NORM_INF), 0.5);
}

TEST(PartedStill, RedEmbersBelowYellowFlamesStand) {
  const BurningPicture fire;
  cv::Mat picture = fire.units();
  const cv::Rect log(40, 106, 44, 28);
  picture(log).setTo(cv::Scalar(0.1, 0.25, 0.95));
  const PartedStill parted = part(picture, kAll);
  const cv::Vec3f ember = parted.ground.at<cv::Vec3f>(122, 62);
  EXPECT_NEAR(level_of(ember[2]), 0.95, 0.05);
  EXPECT_LT(parted.level.at<float>(122, 62), 0.1);
}

TEST(PartedStill, TheOrangeBodyOfAFlameIsNoEmber) {
  cv::Mat picture = BurningPicture{}.units(), red;
  cv::extractChannel(picture, red, 2);
  picture.setTo(cv::Scalar(0.05, 0.68, 0.75), red > 0.5);
  const cv::Rect body(40, 106, 44, 28);
  picture(body).setTo(cv::Scalar(0.15, 0.52, 0.95));
  const PartedStill parted = part(picture, kAll);
  EXPECT_GT(parted.level.at<float>(120, 62), 0.4);
}

TEST(PartedStill, WhatIsPaleAndLitStandsBesideAFlame) {
  const BurningPicture fire;
  cv::Mat picture = fire.units();
  const cv::Rect wax(10, 90, 50, 60);
  picture(wax).setTo(cv::Scalar(0.55, 0.6, 0.9));
  const PartedStill parted = part(picture, kAll);
  EXPECT_EQ(cv::norm(parted.level(cv::Rect(14, 94, 42, 52)), cv::NORM_INF), 0);
  EXPECT_GT(parted.level.at<float>(fire.bed.y - 20, fire.bed.x), 0.5);
  // As bright and as wide, but a flame's colour.
  picture(wax).setTo(cv::Scalar(0.2, 0.6, 0.9));
  EXPECT_GT(part(picture, kAll).level.at<float>(100, 30), 0.5);
}

TEST(PartedStill, ABlueSceneHasNoFlames) {
  cv::Mat picture = BurningPicture{}.units(), blue;
  cv::cvtColor(picture, blue, cv::COLOR_BGR2RGB);
  const PartedStill parted = part(blue, kAll);
  EXPECT_EQ(parted.contrast, 0);
  EXPECT_EQ(cv::norm(parted.level, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace freshet::synth::animate
