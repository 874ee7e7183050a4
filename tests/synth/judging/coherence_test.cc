#include "synth/judging/coherence.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/synth/judging/made_film.h"

namespace freshet::synth::judging {
namespace {

TEST(JudgingCoherence, AFilmOfTheStillsGrainIsNotCombed) { EXPECT_NEAR(combing(made_film()).value, 0, 0.05); }

TEST(JudgingCoherence, DetailDrawnOutIntoStrandsIsSeenWhereItIs) {
  const Reading reading = combing(made_film([](cv::Mat& frame, int number) {
    if (number < 24) return;
    cv::Mat part = frame.rowRange(60, 120);
    cv::blur(part.clone(), part, {25, 1});
  }));
  EXPECT_GT(reading.value, 0.08);
  const Worst worst = worst_of(reading);
  EXPECT_GE(worst.cell.y, 6);
  EXPECT_GE(worst.span, 2);
}

TEST(JudgingCoherence, SpreadFramesReachFromFirstToLast) {
  EXPECT_EQ(spread_frames(1), std::vector<std::size_t>{0});
  EXPECT_EQ(spread_frames(3), (std::vector<std::size_t>{0, 1, 2}));
  const std::vector<std::size_t> many = spread_frames(100);
  EXPECT_EQ(many.size(), 16u);
  EXPECT_EQ(many.front(), 0u);
  EXPECT_EQ(many.back(), 99u);
}

const cv::Size kSize(320, 256);

cv::Mat everywhere() { return cv::Mat(kSize, CV_8U, cv::Scalar(255)); }

std::vector<cv::Mat> white_grain() {
  std::vector<cv::Mat> film(16);
  cv::RNG random(9 * 0x9E3779B97F4A7C15u);
  for (cv::Mat& luma : film) {
    luma.create(kSize, CV_8U);
    random.fill(luma, cv::RNG::NORMAL, 128, 20);
  }
  return film;
}

std::vector<cv::Mat> stripes(double angle) {
  cv::Mat luma(kSize, CV_8U);
  for (int y = 0; y < luma.rows; ++y)
    for (int x = 0; x < luma.cols; ++x)
      luma.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(
          128 + 80 * std::sin(0.5 * (x * std::cos(angle) + y * std::sin(angle))));
  return {luma};
}

TEST(JudgingCoherence, StripesAreCoherentAndGrainIsNot) {
  for (const double angle : {0.0, 0.6, 1.2}) EXPECT_GT(mean_coherence(stripes(angle), everywhere()), 0.97);
  EXPECT_LT(mean_coherence(white_grain(), everywhere()), 0.2);
}

// Half across, half along, in squares far larger than the tensor's reach against both mixed in each place.
TEST(JudgingCoherence, CrossedStripesHaveNoDirection) {
  const cv::Mat crossed = stripes(0)[0] / 2 + stripes(std::numbers::pi / 2)[0] / 2;
  EXPECT_LT(mean_coherence(std::vector{crossed}, everywhere()), 0.15);
}

TEST(JudgingCoherence, WhatIsOutsideTheMatteDoesNotCount) {
  std::vector<cv::Mat> film = white_grain();
  cv::Mat matte = everywhere();
  matte(cv::Rect(160, 0, 160, 256)) = 0;
  const double coherence = mean_coherence(film, matte);
  for (cv::Mat& frame : film) frame(cv::Rect(240, 0, 80, 256)) = 0;
  EXPECT_NEAR(mean_coherence(film, matte), coherence, 1e-6);
}

}  // namespace
}  // namespace freshet::synth::judging
