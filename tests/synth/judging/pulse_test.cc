#include "synth/judging/pulse.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/synth/judging/made_film.h"

namespace freshet::synth::judging {
namespace {

TEST(JudgingPulse, ABeatIsSeenAndATrendIsNot) {
  const double clean = pulse(made_film()).value;
  EXPECT_LT(clean, 1);
  const double beats = pulse(made_film([](cv::Mat& frame, int number) {
                         frame += cv::Scalar::all(12 * std::sin(number * 0.8));
                       })).value;
  EXPECT_NEAR(beats, 12 / std::sqrt(2.0), 1);
  const double drifts =
      pulse(made_film([](cv::Mat& frame, int number) { frame += cv::Scalar::all(number); })).value;
  EXPECT_NEAR(drifts, clean, 0.5);
}

TEST(JudgingPulse, TheMapShowsThePartThatBeats) {
  const Worst worst = worst_of(pulse(made_film([](cv::Mat& frame, int number) {
    cv::Mat part = frame(cv::Rect(20, 20, 30, 30));
    part += cv::Scalar::all(number % 2 == 0 ? 30 : 0);
  })));
  EXPECT_TRUE(cv::Rect(2, 2, 3, 3).contains(worst.cell)) << worst.cell;
}

}  // namespace
}  // namespace freshet::synth::judging
