#include "synth/takes/trial.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "freshet/error.h"
#include "tests/synth/takes/trial_scene.h"

namespace freshet::synth::takes {
namespace {

const TrialOptions kSmall{.side = 96, .frames = 16};

TEST(Trial, TakesAreSmallBeginAsThePictureAndMoveApart) {
  const TrialScene scene;
  const Trial trial =
      try_takes(scene.subject(), {{.name = "as asked"}, {.name = "faster", .speed = 2}}, kSmall);
  ASSERT_EQ(trial.takes.size(), 2u);
  const auto &asked = trial.takes[0].film, &faster = trial.takes[1].film;
  EXPECT_EQ(asked.size(), cv::Size(96, 72));
  EXPECT_EQ(asked.count(), 16);
  // On grain in colour, to two levels in the mean, as whole animations begin.
  EXPECT_LT(cv::norm(asked.frames().front(), asked.still(), cv::NORM_L1) / (3.0 * 96 * 72), 2);
  EXPECT_GT(cv::norm(asked.frames().back(), faster.frames().back(), cv::NORM_INF), 8);
}

// Of a picture at a half, its patches' motion is half as many pixels.
TEST(Trial, ReducedMotionIsTheWholesReduced) {
  TrialScene scene;
  std::get<animate::CarriedOptions>(scene.options.method).innovations.reset();
  const Trial half = try_takes(scene.subject(), {{.name = "as asked"}}, kSmall);
  const Trial whole = try_takes(scene.subject(), {{.name = "as asked"}}, {.side = 192, .frames = 16});
  const auto speed = [](const Trial& trial) {
    return trial.takes[0].verdict.of(judging::Measure::kSpeed).reading.value;
  };
  EXPECT_NEAR(speed(whole) / speed(half), 2, 0.5);
}

TEST(Trial, ATakeHasToBeBetterByTheMargin) {
  const TrialScene scene;
  const std::vector<Take> takes{
      {.name = "as asked"}, {.name = "slower", .speed = 0.5}, {.name = "faster", .speed = 2}};
  TrialOptions options = kSmall;
  options.margin = 1000;
  EXPECT_EQ(try_takes(scene.subject(), takes, options).best, 0u);
  options.margin = 0;
  const Trial trial = try_takes(scene.subject(), takes, options);
  for (const JudgedTake& take : trial.takes)
    EXPECT_GE(take.verdict.faults, trial.takes[trial.best].verdict.faults);
  EXPECT_EQ(why(trial, trial.best), "chosen");
  for (std::size_t i = 0; i < takes.size(); ++i) EXPECT_FALSE(why(trial, i).empty());
}

// The trial's fluid has no flames.
TEST(Trial, ATakeThatCannotBeMadeLosesWithItsReason) {
  const TrialScene scene;
  const Trial trial =
      try_takes(scene.subject(), {{.name = "as asked"}, {.name = "flames", .forms = true}}, kSmall);
  EXPECT_EQ(trial.best, 0u);
  EXPECT_NE(why(trial, 1).find("not made: "), std::string::npos) << why(trial, 1);
}

TEST(Trial, IsTheSameForAnyNumberOfThreads) {
  const TrialScene scene;
  const std::vector<Take> takes{{.name = "as asked"}, {.name = "shorter", .life = 0.5}};
  const Trial all = try_takes(scene.subject(), takes, kSmall);
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  const Trial alone = try_takes(scene.subject(), takes, kSmall);
  EXPECT_EQ(all.best, alone.best);
  for (std::size_t i = 0; i < takes.size(); ++i)
    EXPECT_EQ(all.takes[i].verdict.faults, alone.takes[i].verdict.faults);
}

TEST(Trial, StopsWhenAsked) {
  const TrialScene scene;
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(try_takes(scene.subject(), {{.name = "as asked"}}, kSmall, {}, stop.get_token()), Error);
}

}  // namespace
}  // namespace freshet::synth::takes
