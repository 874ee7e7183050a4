#include "synth/judging/stretch.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/synth/judging/made_film.h"

namespace freshet::synth::judging {
namespace {

/// Flow of a map of places to places, the same in each pair.
FilmMotion motion_of(const std::function<cv::Vec2f(cv::Point)>& flow) {
  cv::Mat field(kMadeSize, CV_32FC2);
  for (int y = 0; y < field.rows; ++y)
    for (int x = 0; x < field.cols; ++x) field.at<cv::Vec2f>(y, x) = flow({x, y});
  FilmMotion motion;
  motion.runs.push_back({.first = 0, .flow = std::vector<cv::Mat>(kRunPairs, field)});
  motion.mean = field;
  motion.speed = cv::Mat::zeros(kMadeSize, CV_32F);
  return motion;
}

TEST(JudgingStretch, DriftDrawsNothingOut) {
  EXPECT_NEAR(stretch(made_film(), motion_of([](cv::Point) { return cv::Vec2f(3, 1); })).value, 0, 0.01);
}

// Drawn out by a hundredth of the way each frame: 25 / 4 frames of log2(1.01) octaves.
TEST(JudgingStretch, ASteadyPullReadsItsOctavesInAQuarterOfASecond) {
  const Reading reading =
      stretch(made_film(),
              motion_of([](cv::Point at) { return cv::Vec2f(0.01F * static_cast<float>(at.x - 80), 0); }));
  EXPECT_NEAR(reading.value, 25.0 / 4 * std::log2(1.01), 0.01);
}

TEST(JudgingStretch, AFoldIsSeenWhereItIs) {
  const Worst worst = worst_of(stretch(
      made_film(), motion_of([](cv::Point at) { return at.x < 120 ? cv::Vec2f(3, 0) : cv::Vec2f(-3, 0); })));
  EXPECT_TRUE(worst.cell.x >= 10 && worst.cell.x <= 13) << worst.cell;
  EXPECT_GT(worst.value, 2);
}

// Of frames: grain that is pulled apart from a middle, and the same that drifts.
TEST(JudgingStretch, IsToldFromFramesAlone) {
  const cv::Mat grain = made_grain(5, {400, 300});
  const auto film = [&](double pull) {
    const auto frame = [&](int t) {
      cv::Mat out;
      const double scale = std::pow(1 + pull, t);
      const cv::Matx23d map(1 / scale, 0, 200 - 80 / scale + (pull > 0 ? 0 : t), 0, 1, 90);
      cv::warpAffine(grain, out, map, kMadeSize, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
      return out;
    };
    Evidence evidence(frame(0), cv::Mat(kMadeSize, CV_8U, cv::Scalar(255)), 25);
    for (int t = 0; t < 24; ++t) evidence.add(frame(t));
    return evidence;
  };
  const Evidence pulled = film(0.03), drifts = film(0);
  const double out = stretch(pulled, film_motion(pulled)).value,
               straight = stretch(drifts, film_motion(drifts)).value;
  EXPECT_GT(out, straight + 0.1) << straight;
}

}  // namespace
}  // namespace freshet::synth::judging
