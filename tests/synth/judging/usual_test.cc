#include "synth/judging/usual.h"

#include <string>

#include <gtest/gtest.h>

namespace freshet::synth::judging {
namespace {

TEST(JudgingUsual, EveryMeasureHasItsWordsAndASpanForEveryKind) {
  for (int i = 0; i < kMeasures; ++i) {
    const auto measure = static_cast<Measure>(i);
    EXPECT_EQ(words_of(measure).measure, measure) << words_of(measure).name;
    EXPECT_FALSE(std::string(words_of(measure).remedy).empty());
    if (measure == Measure::kSpeed) continue;
    for (const char* kind : {"water", "fire", "smoke", "clouds", "lava"}) {
      const Usual usual = usual_of(measure, kind);
      EXPECT_GT(usual.step, 0) << words_of(measure).name << " " << kind;
      EXPECT_LT(usual.from, usual.until) << words_of(measure).name << " " << kind;
    }
  }
}

TEST(JudgingUsual, SpeedsOfAKindAreARange) {
  for (const char* kind : {"water", "fire", "smoke", "clouds", ""}) {
    const SpeedRange range = usual_speed(kind);
    EXPECT_LT(range.slow, range.natural) << kind;
    EXPECT_LT(range.natural, range.fast) << kind;
  }
  EXPECT_LT(usual_speed("clouds").natural, usual_speed("fire").natural);
}

TEST(JudgingUsual, PacesGrowWithThePicture) {
  EXPECT_LT(speed_of("water", "slow", {640, 480}), speed_of("water", "natural", {640, 480}));
  EXPECT_DOUBLE_EQ(speed_of("fire", "fast", {1280, 720}), 2 * speed_of("fire", "fast", {360, 640}));
}

}  // namespace
}  // namespace freshet::synth::judging
