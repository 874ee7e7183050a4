#include "synth/scene/rendering/water_mirror.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/synth/scene/layers/made_layers.h"
#include "tests/synth/scene/made_scene.h"

namespace freshet::synth::scene {
namespace {

constexpr int kHorizon = 50;
const cv::Size kSize(120, 100);

/// Clouds above the horizon, CV_32FC4, nothing below.
cv::Mat sky(int moved_px) {
  cv::Mat wide = made_texture({kSize.width + 40, kHorizon}, {0.7, 0.6, 0.5}, 0.3f, 7), bgra;
  cv::GaussianBlur(wide, wide, {}, 2);
  cv::cvtColor(wide.colRange(20 - moved_px, 20 - moved_px + kSize.width), bgra, cv::COLOR_BGR2BGRA);
  cv::Mat out(kSize, CV_32FC4, cv::Scalar::all(0));
  bgra.copyTo(out.rowRange(0, kHorizon));
  return out;
}
cv::Mat mirrored(const cv::Mat& above) {
  cv::Mat flipped, out;
  cv::flip(above.rowRange(0, kHorizon), flipped, 0);
  cv::cvtColor(flipped, out, cv::COLOR_BGRA2BGR);
  return out;
}
/// The lake below the horizon with these colours.
Sprite lake(const cv::Mat& colour) {
  cv::Mat picture(kSize, CV_32FC3, cv::Scalar::all(0)), alpha(kSize, CV_32F, cv::Scalar(0));
  colour.copyTo(picture.rowRange(kHorizon, kSize.height));
  alpha.rowRange(kHorizon, kSize.height).setTo(1);
  return make_sprite(picture, alpha, Outline::kHeld);
}
cv::Mat shown(const Sprite& sprite) {
  cv::Mat colour;
  constexpr int kBorder = Sprite::kBorder;
  cv::cvtColor(sprite.texture(cv::Rect({kBorder, kBorder}, sprite.box.size())), colour, cv::COLOR_BGRA2BGR);
  return colour;
}
const Line kLine{{0, kHorizon}, {120, kHorizon}};

TEST(WaterMirror, WhatMovesAboveMovesInTheWaterAsMuchAsItsColoursSay) {
  const cv::Mat dimmed = mirrored(sky(0)) * 0.6 + cv::Scalar(0.1, 0.05, 0.02);
  Sprite water = lake(dimmed);
  WaterMirror mirror(water, kLine, sky(0));
  mirror.reflect(sky(0), water);
  EXPECT_LT(cv::norm(shown(water), dimmed, cv::NORM_INF), 1e-5);
  mirror.reflect(sky(6), water);
  const cv::Mat expected = mirrored(sky(6)) * 0.6 + cv::Scalar(0.1, 0.05, 0.02);
  EXPECT_LT(cv::norm(shown(water), expected, cv::NORM_INF), 0.01);
  EXPECT_GT(cv::norm(shown(water), dimmed, cv::NORM_INF), 0.05);
  cv::Mat alpha;
  cv::extractChannel(water.texture, alpha, 3);
  EXPECT_EQ(cv::norm(alpha - 1, cv::NORM_INF), 0);
}

TEST(WaterMirror, WhereTheWaterMirrorsSomethingElseNothingMoves) {
  cv::Mat dimmed = mirrored(sky(0)) * 0.6;
  const cv::Rect hull(30, 10, 30, 30);
  dimmed(hull).setTo(cv::Scalar(0.02, 0.3, 0.9));
  Sprite water = lake(dimmed);
  WaterMirror mirror(water, kLine, sky(0));
  mirror.reflect(sky(6), water);
  const cv::Rect inside(40, 20, 10, 10);
  EXPECT_LT(cv::norm(shown(water)(inside), dimmed(inside), cv::NORM_INF), 0.005);
}

TEST(WaterMirror, ASceneThatMirrorsIsOtherAndLoops) {
  const std::string still = made_scene_text("speed = 30");
  std::string text = still;
  text.replace(text.find("horizon"), 0, "mirrors = true\n");
  cv::Mat frames[3];
  MadeScene plain(still), made(text);
  for (MadeScene* one : {&plain, &made}) {
    // The lake holds what it mirrors.
    cv::Mat flipped;
    cv::flip(one->picture().rowRange(0, 58), flipped, 0);
    one->pixels()[2].colour = one->picture().clone();
    cv::Mat lower = one->pixels()[2].colour.rowRange(58, 116);
    flipped.convertTo(lower, -1, 0.7);
  }
  plain.animation().render(10, frames[0]);
  made.animation().render(10, frames[1]);
  EXPECT_GT(cv::norm(frames[0].rowRange(62, 116), frames[1].rowRange(62, 116), cv::NORM_INF), 10);
  EXPECT_EQ(cv::norm(frames[0].rowRange(0, 50), frames[1].rowRange(0, 50), cv::NORM_INF), 0);
  made.animation().render(30, frames[2]);
  EXPECT_EQ(cv::norm(frames[1], frames[2], cv::NORM_INF), 0);
}

}  // namespace
}  // namespace freshet::synth::scene
