#include "synth/judging/reading.h"

#include <cmath>

#include <gtest/gtest.h>

namespace freshet::synth::judging {
namespace {

TEST(JudgingReading, CellsAreSixteenAlongTheLongerSide) {
  EXPECT_EQ(cells_of({320, 240}), cv::Size(16, 12));
  EXPECT_EQ(cells_of({100, 400}), cv::Size(4, 16));
  EXPECT_EQ(cells_of({400, 3}), cv::Size(16, 1));
}

TEST(JudgingReading, CellsAreMeansOfTheFluidAlone) {
  cv::Mat values(64, 64, CV_32F, cv::Scalar(5)), matte(64, 64, CV_8U, cv::Scalar(255));
  values.colRange(0, 2) = 9;
  matte.colRange(0, 2) = 0;
  matte.rowRange(60, 64) = 0;
  const cv::Mat cells = cell_means(values, matte);
  EXPECT_FLOAT_EQ(cells.at<float>(0, 0), 5);
  EXPECT_TRUE(std::isnan(cells.at<float>(15, 3)));
  EXPECT_FLOAT_EQ(static_cast<float>(mean_of(cells)), 5);
}

TEST(JudgingReading, TheWorstIsTheGreatestOfAllSpans) {
  Reading reading;
  EXPECT_FALSE(worst_of(reading).found);
  for (int span = 0; span < kSpans; ++span) reading.map.push_back(cv::Mat::zeros(3, 4, CV_32F));
  reading.map[2].at<float>(1, 3) = 7;
  reading.map[1].at<float>(0, 0) = std::nanf("");
  const Worst worst = worst_of(reading);
  EXPECT_TRUE(worst.found);
  EXPECT_EQ(worst.cell, cv::Point(3, 1));
  EXPECT_EQ(worst.span, 2);
}

TEST(JudgingReading, SpansDivideTheFrames) {
  EXPECT_EQ(span_of(0, 40), 0);
  EXPECT_EQ(span_of(10, 40), 1);
  EXPECT_EQ(span_of(39, 40), 3);
}

}  // namespace
}  // namespace freshet::synth::judging
