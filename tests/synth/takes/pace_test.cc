// A pace as a factor of playing.

#include "synth/takes/pace.h"

#include <cmath>

#include <gtest/gtest.h>

#include "synth/judging/usual.h"
#include "tests/synth/takes/trial_scene.h"

namespace freshet::synth::takes {
namespace {

constexpr int kSide = 640;

TEST(Pace, AFactorBringsWhatIsFilmedToWhatTheKindHas) {
  const cv::Size picture(kSide, 480);
  for (const auto kind : judging::kKinds)
    for (const char* const pace : {"slow", "natural", "fast"})
      EXPECT_NEAR(30 * factor_of(pace, kind, {30, 10}, picture), judging::speed_of(kind, pace, picture),
                  1e-9);
  EXPECT_LT(factor_of("slow", "water", {30, 30}, picture), factor_of("fast", "water", {30, 30}, picture));
}

TEST(Pace, ByItselfItGoesHalfTheWayInOctaves) {
  const cv::Size picture(kSide, 480);
  const double natural = judging::usual_speed("fire").natural * kSide;
  EXPECT_NEAR(factor_of("auto", "fire", {natural, 1}, picture), 1, 1e-9);
  EXPECT_NEAR(factor_of("auto", "fire", {natural / 16, 1}, picture), 4, 1e-9);
  EXPECT_NEAR(factor_of("auto", "fire", {natural * 4, 1}, picture), 0.5, 1e-9);
}

TEST(Pace, OfCloudsAndSmokeItIsTheUsualClipThatGoesHalfTheWay) {
  const cv::Size picture(kSide, 480);
  for (const char* const kind : {"clouds", "smoke"}) {
    const double natural = judging::usual_speed(kind).natural * kSide;
    EXPECT_NEAR(factor_of("auto", kind, {natural, natural}, picture), 1, 1e-9);
    EXPECT_NEAR(factor_of("auto", kind, {4 * natural, natural}, picture), 0.25, 1e-9);
  }
  const double natural = judging::usual_speed("water").natural * kSide;
  EXPECT_NEAR(factor_of("auto", "water", {4 * natural, natural}, picture), 0.5, 1e-9);
}

TEST(Pace, OfAKindThatNobodyMeasuredItIsAsFilmed) {
  EXPECT_EQ(factor_of("auto", "lava", {3, 3}, {kSide, kSide}), 1);
  EXPECT_EQ(factor_of("auto", "", {3, 3}, {kSide, kSide}), 1);
}

TEST(Pace, WhatHardlyMovesIsNotSpedUpWithoutEnd) {
  EXPECT_EQ(factor_of("fast", "fire", {}, {kSide, kSide}), 20);
  EXPECT_EQ(factor_of("slow", "water", {1e9, 1e9}, {kSide, kSide}), 0.05);
}

TEST(Pace, WhatIsFilmedIsTheClipsMotionInsideTheMatte) {
  const TrialScene scene;
  const double fps = 25;
  const Filmed filmed =
      filmed_speed(scene.store.snapshot(), scene.store.settings(), scene.assignment, scene.matte);
  EXPECT_NEAR(filmed.mean, std::hypot(2, 1) * fps, 3);
  EXPECT_NEAR(filmed.usual, std::hypot(2, 1) * fps, 3);
}

TEST(Pace, TheUsualClipIsTheGeometricMeanAndOneThatRestsCountsAsATenth) {
  // The left half by one clip, the right half by another.
  const auto filmed = [](cv::Vec2f right) {
    const animate::FlowingStore store(
        {animate::measured({.size = {200, 160}, .frames = 30, .steady = {2, 0}}),
         animate::measured({.size = {200, 160}, .frames = 30, .steady = right})});
    query::Assignment assignment;
    assignment.picture = {192, 144};
    assignment.clips = {{"0.mkv", "clouds", "", "hash of 0.mkv"}, {"1.mkv", "clouds", "", "hash of 1.mkv"}};
    for (int y = 0; y + 48 <= 144; y += 48)
      for (int x = 0; x + 48 <= 192; x += 48)
        assignment.pieces.push_back(
            {.corner = {x, y}, .clip = x < 96 ? 0U : 1U, .variant = {}, .patch = {x / 2, y / 2}});
    return filmed_speed(store.snapshot(), store.settings(), assignment, cv::Mat(144, 192, CV_8U, 255));
  };
  const Filmed fast = filmed({8, 0});
  EXPECT_NEAR(fast.mean, 125, 5);
  EXPECT_NEAR(fast.usual, 100, 5);
  const Filmed rests = filmed({0, 0});
  EXPECT_NEAR(rests.mean, 25, 2);
  EXPECT_NEAR(rests.usual, std::sqrt(50 * 2.5), 1);
}

}  // namespace
}  // namespace freshet::synth::takes
