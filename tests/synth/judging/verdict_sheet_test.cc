#include "synth/judging/verdict_sheet.h"

#include <gtest/gtest.h>

#include "tests/synth/judging/made_film.h"

namespace freshet::synth::judging {
namespace {

TEST(JudgingVerdictSheet, ShowsTheStillAndTheWorstFrames) {
  const cv::Mat first = made_film().frames().front();
  const Evidence film = made_film([&](cv::Mat& frame, int) { first.copyTo(frame); });
  const Verdict verdict = judge(film, "water");
  const cv::Mat sheet = verdict_sheet(verdict, film);
  ASSERT_EQ(sheet.type(), CV_8UC3);
  EXPECT_GE(sheet.cols, 2 * kMadeSize.width);
  cv::Mat difference;
  cv::absdiff(sheet(cv::Rect({0, 0}, kMadeSize)), film.still(), difference);
  EXPECT_EQ(cv::norm(difference, cv::NORM_INF), 0);
  cv::absdiff(sheet(cv::Rect({kMadeSize.width + 4, 0}, kMadeSize)), film.still(), difference);
  EXPECT_GT(cv::norm(difference, cv::NORM_INF), 50);  // tinted
}

}  // namespace
}  // namespace freshet::synth::judging
