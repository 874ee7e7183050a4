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
      EXPECT_NEAR(30 * factor_of(pace, kind, 30, picture), judging::speed_of(kind, pace, picture), 1e-9);
  EXPECT_LT(factor_of("slow", "water", 30, picture), factor_of("fast", "water", 30, picture));
}

TEST(Pace, ByItselfItGoesHalfTheWayInOctaves) {
  const cv::Size picture(kSide, 480);
  const double natural = judging::usual_speed("fire").natural * kSide;
  EXPECT_NEAR(factor_of("auto", "fire", natural, picture), 1, 1e-9);
  EXPECT_NEAR(factor_of("auto", "fire", natural / 16, picture), 4, 1e-9);
  EXPECT_NEAR(factor_of("auto", "fire", natural * 4, picture), 0.5, 1e-9);
}

TEST(Pace, OfAKindThatNobodyMeasuredItIsAsFilmed) {
  EXPECT_EQ(factor_of("auto", "lava", 3, {kSide, kSide}), 1);
  EXPECT_EQ(factor_of("auto", "", 3, {kSide, kSide}), 1);
}

TEST(Pace, WhatHardlyMovesIsNotSpedUpWithoutEnd) {
  EXPECT_EQ(factor_of("fast", "fire", 0, {kSide, kSide}), 20);
  EXPECT_EQ(factor_of("slow", "water", 1e9, {kSide, kSide}), 0.05);
}

TEST(Pace, WhatIsFilmedIsTheClipsMotionInsideTheMatte) {
  const TrialScene scene;
  const double fps = 25;
  EXPECT_NEAR(filmed_speed(scene.store.snapshot(), scene.store.settings(), scene.assignment, scene.matte),
              std::hypot(2, 1) * fps, 3);
}

}  // namespace
}  // namespace freshet::synth::takes
