#include "bench/quality/quality_recurrence.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::bench {
namespace {

const cv::Size kSize(160, 96);

cv::Mat everywhere() { return cv::Mat(kSize, CV_8U, cv::Scalar(255)); }

cv::Mat grain(int seed) {
  cv::Mat luma(kSize, CV_8U);
  cv::RNG random(static_cast<std::uint64_t>(seed) * 0x9E3779B97F4A7C15u);
  random.fill(luma, cv::RNG::UNIFORM, 60, 196);
  cv::GaussianBlur(luma, luma, {}, 1.5);
  return luma;
}

TEST(QualityRecurrence, FormsThatAreNewInEveryFrameDoNotComeAgain) {
  std::vector<cv::Mat> film;
  for (int i = 0; i < 40; ++i) film.push_back(grain(i + 1));
  EXPECT_LT(comes_again(film, everywhere()), 0.15);
}

TEST(QualityRecurrence, AFilmThatRepeatsAfterHalfItsFramesComesAgainWholly) {
  std::vector<cv::Mat> film;
  for (int i = 0; i < 40; ++i) film.push_back(grain(i % 20 + 1));
  EXPECT_GT(comes_again(film, everywhere()), 0.99);
}

TEST(QualityRecurrence, WhatStandsIsNoFormAndOnlyTheMatteCounts) {
  std::vector<cv::Mat> film;
  const cv::Mat ground = grain(99);
  cv::Mat left = everywhere();
  left.colRange(60, kSize.width) = 0;
  for (int i = 0; i < 40; ++i) {
    film.push_back(0.5 * grain(i + 1) + 0.5 * ground);
    cv::Mat right = film.back().colRange(100, kSize.width);
    grain(i % 20 + 1).colRange(100, kSize.width).copyTo(right);  // comes again, beyond the matte
  }
  EXPECT_LT(comes_again(film, left), 0.2);
  EXPECT_GT(comes_again(film, everywhere()), comes_again(film, left) + 0.2);
}

TEST(QualityRecurrence, ShortFilmsAreNotMeasured) {
  EXPECT_TRUE(std::isnan(comes_again(std::vector<cv::Mat>(kRecurrenceGap, grain(1)), everywhere())));
}

TEST(QualityRecurrence, DriftIsThatOfTheFarthestFrameAndChannelInsideTheMatte) {
  const cv::Mat still(kSize, CV_8UC3, cv::Scalar(50, 100, 150));
  cv::Mat redder = still + cv::Scalar(0, 0, 7), beside = still.clone(), left = everywhere();
  left.colRange(80, kSize.width) = 0;
  beside.colRange(80, kSize.width) = cv::Scalar(0, 0, 0);
  EXPECT_NEAR(colour_drift(std::vector{still, redder, still}, still, everywhere()), 7, 1e-3);
  EXPECT_NEAR(colour_drift(std::vector{still, beside}, still, left), 0, 1e-3);
}

TEST(QualityRecurrence, DetailThatMovesIsNoDrift) {
  cv::Mat still, moved;
  cv::merge(std::vector<cv::Mat>{grain(1), grain(1), grain(1)}, still);
  cv::merge(std::vector<cv::Mat>{grain(2), grain(2), grain(2)}, moved);
  EXPECT_LT(colour_drift(std::vector{moved}, still, everywhere()), 2);
}

}  // namespace
}  // namespace freshet::bench
