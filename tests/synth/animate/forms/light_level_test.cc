#include "synth/animate/forms/light_level.h"

#include <gtest/gtest.h>

#include "media/picture/light.h"

namespace freshet::synth::animate {
namespace {

TEST(Light, IsTheCurveOfThePicturesAndItsInverse) {
  for (int i = 0; i <= 1000; ++i) {
    const float level = static_cast<float>(i) / 1000;
    EXPECT_NEAR(light_of(level), media::linear_of(level), 1e-5);
    EXPECT_NEAR(level_of(light_of(level)), level, 1e-3);
  }
  EXPECT_EQ(light_of(0.0f), 0);
  EXPECT_EQ(level_of(-0.5f), 0);
  EXPECT_NEAR(level_of(7.0f), 1, 1e-6);
}

TEST(Light, WhatThinsOutKeepsItsCoreAndGoesAltogether) {
  EXPECT_NEAR(thinned(0.4f, 0), 0.4f, 1e-5);
  EXPECT_EQ(thinned(0.3f, 0.3f), 0);
  EXPECT_NEAR(thinned(1, 0.7f), 1, 1e-4);
  EXPECT_LT(thinned(0.8f, 0.5f), 0.8f);
  EXPECT_EQ(thinned(1, 1), 0);
}

}  // namespace
}  // namespace freshet::synth::animate
