#include "ingest/film_trace.h"

#include <gtest/gtest.h>

#include <vector>

#include <opencv2/imgproc.hpp>

#include "tests/ingest/synthetic_clip.h"

namespace freshet::ingest {
namespace {

constexpr int kFps = 25;

std::vector<cv::Mat> fluid(int start, int frames) {
  return render({.size = {384, 216},
                 .frames = frames,
                 .moving = {60, 40, 280, 160},
                 .changing = true,
                 .start = start,
                 .coarse = true});
}

FilmTrace trace_of(const std::vector<cv::Mat>& film, double fps = kFps) {
  FilmTrace trace(fps);
  for (const cv::Mat& luma : film) trace.add(luma);
  return trace;
}

TEST(FilmTrace, KnowsAFilmAgainThatWasCutScaledAndBrightened) {
  const std::vector<cv::Mat> film = fluid(0, 75);
  std::vector<cv::Mat> copy;
  for (int t = 20; t < 60; ++t) {
    cv::Mat small;
    cv::resize(film[t], small, {200, 120}, 0, 0, cv::INTER_AREA);
    small.convertTo(copy.emplace_back(), CV_8U, 0.8, 20);
  }
  const auto found = overlap(trace_of(copy), trace_of(film));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->seconds, 40.0 / kFps, 1e-9);
  EXPECT_GT(found->correlation, 0.95);
  const auto swapped = overlap(trace_of(film), trace_of(copy));
  ASSERT_TRUE(swapped);
  EXPECT_NEAR(swapped->seconds, found->seconds, 1e-9);
}

TEST(FilmTrace, KnowsHalfTheRateAndAPartialOverlap) {
  const std::vector<cv::Mat> film = fluid(0, 120);
  std::vector<cv::Mat> copy;
  for (int t = 60; t < 180; t += 2) copy.push_back(t < 120 ? film[t] : fluid(t, 1).front());
  const auto found = overlap(trace_of(film, 50), trace_of(copy, 25));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->seconds, 60.0 / 50, 0.05);
}

TEST(FilmTrace, AnotherStretchOfTheSceneIsNoCopy) {
  EXPECT_FALSE(overlap(trace_of(fluid(0, 50)), trace_of(fluid(400, 50))));
}

TEST(FilmTrace, WhereNothingMovesNothingIsAlike) {
  const std::vector<cv::Mat> still(50, fluid(0, 1).front());
  EXPECT_FALSE(overlap(trace_of(still), trace_of(still)));
}

TEST(FilmTrace, LessThanASecondIsNotCompared) {
  const std::vector<cv::Mat> film = fluid(0, 50);
  const FilmTrace trace = trace_of(film);
  EXPECT_FALSE(overlap(trace, trace.part(0, kFps - 1)));
  EXPECT_TRUE(overlap(trace, trace.part(3, 3 + kFps)));
}

}  // namespace
}  // namespace freshet::ingest
