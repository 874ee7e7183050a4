#include "synth/judging/asked_motion.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/synth/judging/made_film.h"

namespace freshet::synth::judging {
namespace {

Asked towards(float x, float y) { return {cv::Mat(kMadeSize, CV_32FC2, cv::Scalar(x, y)), {}}; }

TEST(JudgingAskedMotion, TheAngleIsThatBetweenMotionAndWhatWasAsked) {
  const Evidence film = made_film();  // drifts right
  const FilmMotion motion = film_motion(film);
  EXPECT_LT(motion_angle(film, motion, towards(1, 0), "water").value, 15);
  EXPECT_NEAR(motion_angle(film, motion, towards(0, 1), "water").value, 90, 15);
  EXPECT_GT(motion_angle(film, motion, towards(-1, 0), "water").value, 165);
  EXPECT_TRUE(std::isnan(motion_angle(film, motion, {}, "water").value));
}

TEST(JudgingAskedMotion, WhatGoesUpMayComeDownBesideWhatRises) {
  const Evidence film = made_film();
  FilmMotion falls = film_motion(film);
  for (auto& moves : cv::Mat_<cv::Vec2f>(falls.mean)) moves = {-moves[1], moves[0]};  // right becomes down
  FilmMotion both = falls;
  both.mean = falls.mean.clone();
  both.mean.colRange(60, 100) *= -1;
  EXPECT_GT(motion_angle(film, falls, towards(0, -1), "water").value, 165);
  EXPECT_LT(motion_angle(film, both, towards(0, -1), "water").value, 15);
  EXPECT_GT(motion_angle(film, both, towards(0, -1), "smoke").value, 75);
  EXPECT_GT(motion_angle(film, both, towards(-1, 0), "water").value, 75) << "but not go aside";
}

TEST(JudgingAskedMotion, TheSpeedAskedIsComparedInOctavesWhereItWasAsked) {
  const Evidence film = made_film();  // 25 px/s
  const FilmMotion motion = film_motion(film);
  const auto asked = [](float speed) { return Asked{{}, cv::Mat(kMadeSize, CV_32F, cv::Scalar(speed))}; };
  EXPECT_LT(speed_ratio(film, motion, asked(25)).value, 0.5);
  EXPECT_NEAR(speed_ratio(film, motion, asked(200)).value, 3, 0.5);
  EXPECT_TRUE(std::isnan(speed_ratio(film, motion, asked(-1)).value));
  EXPECT_TRUE(std::isnan(speed_ratio(film, motion, {}).value));
}

TEST(JudgingAskedMotion, SpeedIsInPixelsOfThePicture) {
  const Evidence film = made_film();
  EXPECT_NEAR(mean_speed(film, film_motion(film)).value, 25, 8);
}

}  // namespace
}  // namespace freshet::synth::judging
