#include "synth/judging/seams.h"

#include <gtest/gtest.h>

#include "tests/synth/judging/made_film.h"

namespace freshet::synth::judging {
namespace {

TEST(JudgingSeams, GrainThatMovesHasNone) { EXPECT_LT(seams(made_film()).value, 1.5); }

// A square from elsewhere, lighter by 50 levels, laid in without a soft edge.
TEST(JudgingSeams, APatchWithAHardEdgeIsSeenWhereItIs) {
  const Reading reading = seams(made_film([](cv::Mat& frame, int number) {
    if (number < 36) return;
    cv::Mat part = frame(cv::Rect(90, 30, 40, 40));
    part += cv::Scalar::all(60);
  }));
  EXPECT_GT(reading.value, 1.5 * (seams(made_film()).value + 0.5));
  const Worst worst = worst_of(reading);
  EXPECT_EQ(worst.span, 3);
  EXPECT_TRUE(cv::Rect(8, 2, 6, 6).contains(worst.cell)) << worst.cell;
}

}  // namespace
}  // namespace freshet::synth::judging
