#include "synth/judging/critic.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "synth/judging/film_motion.h"
#include "synth/judging/stretch.h"
#include "tests/synth/judging/made_film.h"

namespace freshet::synth::judging {
namespace {

TEST(JudgingCritic, AFilmWithAPlantedFaultIsWorseThanTheCleanOne) {
  const double clean = judge(made_film(), "water").faults;
  const Verdict fog =
      judge(made_film([](cv::Mat& frame, int) { cv::GaussianBlur(frame.clone(), frame, {}, 3); }));
  EXPECT_GT(fog.of(Measure::kDetailLoss).fault, judge(made_film()).of(Measure::kDetailLoss).fault + 1);
  const cv::Mat first = made_film().frames().front();
  EXPECT_GT(judge(made_film([&](cv::Mat& frame, int) { first.copyTo(frame); }), "water").faults, clean);
  EXPECT_GT(judge(made_film([](cv::Mat& frame, int number) {
                    if (number > 0) frame += cv::Scalar(40, 0, -40);
                  }),
                  "water")
                .faults,
            clean);
}

TEST(JudgingCritic, WordsNameTheFaultItsPlaceAndWhatChangesIt) {
  // Redder at the upper left, without an edge.
  cv::Mat redder(kMadeSize, CV_32F, cv::Scalar(0));
  redder(cv::Rect(0, 0, 60, 50)) = 180;
  cv::GaussianBlur(redder, redder, {}, 20);
  const Evidence film = made_film([&](cv::Mat& frame, int number) {
    if (number == 0) return;
    std::vector<cv::Mat> channels;
    cv::split(frame, channels);
    cv::add(channels[2], redder, channels[2], cv::noArray(), CV_8U);
    cv::subtract(channels[0], redder, channels[0], cv::noArray(), CV_8U);
    cv::merge(channels, frame);
  });
  const std::string words = verdict_words(judge(film), film);
  EXPECT_NE(words.find("colours leave the picture's, most at the upper left"), std::string::npos) << words;
  EXPECT_NE(words.find("To change it: "), std::string::npos) << words;
}

TEST(JudgingCritic, WhatGoesFasterThanItsKindStretchesOverTheKindsWay) {
  const Evidence film = made_film();  // 25 px/s: fast for water of this size, and not for fire
  const double whole = stretch(film, film_motion(film)).value;
  const Verdict water = judge(film, "water");
  EXPECT_DOUBLE_EQ(judge(film, "fire").of(Measure::kStretch).reading.value, whole);
  const double fast = usual_speed("water").fast * kMadeSize.width;
  ASSERT_GT(water.of(Measure::kSpeed).reading.value, fast);
  EXPECT_NEAR(water.of(Measure::kStretch).reading.value,
              whole * fast / water.of(Measure::kSpeed).reading.value, 1e-9);
}

TEST(JudgingCritic, IsTheSameForAnyNumberOfThreads) {
  const Evidence film = made_film();
  const Verdict all = judge(film, "fire");
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  const Verdict alone = judge(film, "fire");
  for (std::size_t i = 0; i < all.findings.size(); ++i) {
    if (std::isnan(all.findings[i].reading.value)) continue;
    EXPECT_EQ(all.findings[i].reading.value, alone.findings[i].reading.value) << i;
  }
}

TEST(JudgingCritic, ShortFilmsAndEmptyMattesAreRefused) {
  EXPECT_THROW(judge(made_film({}, kFewestFrames - 1)), Error);
  const cv::Mat frame(20, 20, CV_8UC3, cv::Scalar::all(9));
  Evidence film(frame, cv::Mat(20, 20, CV_8U, cv::Scalar(0)), 25);
  for (int i = 0; i < kFewestFrames; ++i) film.add(frame);
  EXPECT_THROW(judge(film), Error);
}

}  // namespace
}  // namespace freshet::synth::judging
