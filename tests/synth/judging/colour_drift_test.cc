#include "synth/judging/colour_drift.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/synth/judging/grain.h"
#include "tests/synth/judging/made_film.h"

namespace freshet::synth::judging {
namespace {

TEST(JudgingColourDrift, DriftIsThatOfTheFarthestFrameAndChannelInsideTheMatte) {
  const cv::Mat still(kSize, CV_8UC3, cv::Scalar(50, 100, 150));
  cv::Mat redder = still + cv::Scalar(0, 0, 7), beside = still.clone(), left = everywhere();
  left.colRange(80, kSize.width) = 0;
  beside.colRange(80, kSize.width) = cv::Scalar(0, 0, 0);
  EXPECT_NEAR(colour_drift(std::vector{still, redder, still}, still, everywhere()), 7, 1e-3);
  EXPECT_NEAR(colour_drift(std::vector{still, beside}, still, left), 0, 1e-3);
}

TEST(JudgingColourDrift, DetailThatMovesIsNoDrift) {
  cv::Mat still, moved;
  cv::merge(std::vector<cv::Mat>{grain(1), grain(1), grain(1)}, still);
  cv::merge(std::vector<cv::Mat>{grain(2), grain(2), grain(2)}, moved);
  EXPECT_LT(colour_drift(std::vector{moved}, still, everywhere()), 2);
}

TEST(JudgingColourDrift, AFilmThatTurnsBlueInOneCornerIsSeenThere) {
  const Evidence clean = made_film(), blue = made_film([](cv::Mat&frame, int number) {
                                        cv::Mat corner = frame(cv::Rect(100, 80, 60, 40));
                                        corner += cv::Scalar(number, 0, 0);
                                      });
  EXPECT_LT(colour_drift(clean).value, 6);
  const Reading reading = colour_drift(blue);
  EXPECT_GT(reading.value, colour_drift(clean).value + 5);
  const Worst worst = worst_of(reading);
  EXPECT_EQ(worst.span, kSpans - 1);
  EXPECT_GE(worst.cell.x, 10);
  EXPECT_GE(worst.cell.y, 8);
}

}  // namespace
}  // namespace freshet::synth::judging
