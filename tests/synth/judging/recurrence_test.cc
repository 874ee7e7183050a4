#include "synth/judging/recurrence.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/synth/judging/grain.h"

namespace freshet::synth::judging {
namespace {

TEST(JudgingRecurrence, FormsThatAreNewInEveryFrameDoNotComeAgain) {
  std::vector<cv::Mat> film;
  for (int i = 0; i < 40; ++i) film.push_back(grain(i + 1));
  EXPECT_LT(recurrence(film, everywhere()).value, 0.15);
}

TEST(JudgingRecurrence, AFilmThatRepeatsAfterHalfItsFramesComesAgainWholly) {
  std::vector<cv::Mat> film;
  for (int i = 0; i < 40; ++i) film.push_back(grain(i % 20 + 1));
  EXPECT_GT(recurrence(film, everywhere()).value, 0.99);
}

TEST(JudgingRecurrence, WhatStandsIsNoFormAndOnlyTheMatteCounts) {
  std::vector<cv::Mat> film;
  const cv::Mat ground = grain(99);
  cv::Mat left = everywhere();
  left.colRange(60, kSize.width) = 0;
  for (int i = 0; i < 40; ++i) {
    film.push_back(0.5 * grain(i + 1) + 0.5 * ground);
    cv::Mat right = film.back().colRange(100, kSize.width);
    grain(i % 20 + 1).colRange(100, kSize.width).copyTo(right);  // comes again, beyond the matte
  }
  EXPECT_LT(recurrence(film, left).value, 0.2);
  EXPECT_GT(recurrence(film, everywhere()).value, recurrence(film, left).value + 0.2);
}

TEST(JudgingRecurrence, ShortFilmsAreNotMeasured) {
  EXPECT_TRUE(std::isnan(recurrence(std::vector<cv::Mat>(kRecurrenceGap, grain(1)), everywhere()).value));
}

// The left half begins again every 20 frames, the right half is new in each.
TEST(JudgingRecurrence, TheMapShowsWhereFormsComeBack) {
  std::vector<cv::Mat> film;
  for (int i = 0; i < 40; ++i) {
    film.push_back(grain(i + 100));
    cv::Mat left = film.back().colRange(0, 80);
    grain(i % 20 + 1).colRange(0, 80).copyTo(left);
  }
  const Reading reading = recurrence(film, everywhere());
  ASSERT_EQ(reading.map.size(), static_cast<std::size_t>(kSpans));
  for (const cv::Mat& map : reading.map) {
    EXPECT_GT(mean_of(map.colRange(0, 7)), 0.9);
    EXPECT_LT(mean_of(map.colRange(9, 16)), 0.3);
  }
}

}  // namespace
}  // namespace freshet::synth::judging
