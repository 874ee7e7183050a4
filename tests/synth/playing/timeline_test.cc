#include "synth/playing/timeline.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "tests/harness/fault.h"

namespace freshet::synth::playing {
namespace {

std::vector<double> times_at(double fps, int frames) {
  std::vector<double> times(frames);
  for (int i = 0; i < frames; ++i) times[i] = i / fps;
  return times;
}

const vision::LoopRule kRule{.from = 66, .to = 8, .fade = 12, .distance = 1};

std::vector<Moment> play(const TimelineOptions& options, std::optional<vision::LoopRule> rule = kRule,
                         double fps = 25, int frames = 75) {
  return timeline(times_at(fps, frames), 1 / fps, rule, "clip", options);
}

/// How far b lies after a, frames, for the moment that counts most.
double advance(const Moment& a, const Moment& b) {
  const int heavy = a.weight[1] > a.weight[0] ? 1 : 0, other = b.weight[1] > b.weight[0] ? 1 : 0;
  return b.at[other] - a.at[heavy];
}

TEST(Timeline, PlaysForwardWhereTheClipLastsAndNeedsNoRule) {
  const auto moments = play({.frames = 75}, std::nullopt);
  for (int i = 0; i < 75; ++i) {
    EXPECT_EQ(moments[i].count(), 1);
    EXPECT_NEAR(moments[i].at[0], i, 1e-9);
  }
}

TEST(Timeline, ShowsTheNearestFrameWhenOnlyWholeOnesAreWanted) {
  const auto moments = play({.frames = 75, .whole = true}, std::nullopt, 30, 90);
  for (int i = 0; i < 75; ++i) {
    EXPECT_EQ(moments[i].at[0], std::floor(moments[i].at[0]));
    EXPECT_LE(std::abs(moments[i].at[0] / 30 - i / 25.0), 0.5 / 30 + 1e-9);
  }
}

TEST(Timeline, GoesOnWithoutAnEndByTheRule) {
  const auto moments = play({.frames = 500});
  int fades = 0;
  for (int i = 0; i + 1 < 500; ++i) {
    const double step = advance(moments[i], moments[i + 1]);
    // On by a frame, or from `from` to `to`.
    EXPECT_TRUE(std::abs(step - 1) < 1e-6 || std::abs(step - 1 + kRule.length()) < 1e-6) << i << " " << step;
    fades += std::abs(step - 1) > 1e-6;
    for (int k = 0; k < moments[i].count(); ++k) {
      EXPECT_GE(moments[i].at[k], 0);
      EXPECT_LE(moments[i].at[k], 74);
    }
    if (moments[i].count() == 2) {
      EXPECT_NEAR(moments[i].at[0] - moments[i].at[1], kRule.length(), 1e-6);
    }
  }
  EXPECT_EQ(fades, (500 - 66) / 58 + 1);
}

TEST(Timeline, CrossFadesKeepTheVarianceOfFramesAsAlikeAsTheRuleSays) {
  for (const double distance : {0.0, 0.3, 1.0}) {
    vision::LoopRule rule = kRule;
    rule.distance = distance;
    for (const Moment& m : play({.frames = 500}, rule)) {
      const double correlation = 1 - distance;
      EXPECT_NEAR(
          m.weight[0] * m.weight[0] + m.weight[1] * m.weight[1] + 2 * correlation * m.weight[0] * m.weight[1],
          1, 1e-5);
    }
  }
}

TEST(Timeline, ALoopOfAnyLengthEndsWhereItBegan) {
  for (const int frames : {8, 20, 40, 59, 75, 100, 499, 500})
    for (const double speed : {0.3, 1.0, 2.7})
      for (const double phase : {0.0, 0.37}) {
        const auto moments = play({.frames = frames, .speed = speed, .loop = true, .phase = phase});
        int jumps = 0;
        for (int i = 0; i < frames; ++i) {
          const Moment &a = moments[i], &b = moments[(i + 1) % frames];
          for (int k = 0; k < a.count(); ++k) {
            EXPECT_GE(a.at[k], 0);
            EXPECT_LE(a.at[k], 74);
          }
          // Whatever counts much in a goes on in b: no moment comes or goes at once.
          for (int k = 0; k < a.count(); ++k) {
            if (a.weight[k] < 0.6) continue;
            bool goes_on = false;
            for (int j = 0; j < b.count(); ++j) {
              const double step = (b.at[j] - a.at[k]) / speed;
              goes_on |= i + 1 < frames ? step > 0.99 && step < 1.08 : std::abs(step - 0.5) < 1e-4;
            }
            jumps += !goes_on;
          }
        }
        EXPECT_EQ(jumps, 0) << frames << " " << speed << " " << phase;
      }
}

TEST(Timeline, PhasesSpreadTheFades) {
  const auto fading = [](const std::vector<Moment>& moments) {
    for (std::size_t i = 0; i < moments.size(); ++i)
      if (moments[i].count() == 2) return i;
    return moments.size();
  };
  EXPECT_NE(fading(play({.frames = 100, .loop = true, .phase = 0.1})),
            fading(play({.frames = 100, .loop = true, .phase = 0.7})));
}

TEST(Timeline, SaysWhichClipIsTooShort) {
  for (const bool loop : {false, true}) {
    const std::string what = fault_of(
        ErrorKind::kInput, [&] { play({.frames = loop ? 8 : 50, .loop = loop}, std::nullopt, 25, 11); });
    EXPECT_NE(what.find("clip"), std::string::npos) << what;
    EXPECT_NE(what.find("11 frames"), std::string::npos) << what;
    EXPECT_NE(what.find("20 frames are needed"), std::string::npos) << what;
  }
}

}  // namespace
}  // namespace freshet::synth::playing
