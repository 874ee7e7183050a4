#include "synth/judging/detail_loss.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/synth/judging/made_film.h"

namespace freshet::synth::judging {
namespace {

TEST(JudgingDetailLoss, ALivelyFilmLosesNone) { EXPECT_LT(detail_loss(made_film()).value, 0.15); }

TEST(JudgingDetailLoss, FogIsSeenWhereItIs) {
  const Reading reading = detail_loss(made_film([](cv::Mat& frame, int number) {
    if (number < 12) return;
    cv::Mat part = frame.colRange(0, 60);
    cv::GaussianBlur(part.clone(), part, {}, 3);
  }));
  EXPECT_GT(reading.value, 0.5);
  const Worst worst = worst_of(reading);
  EXPECT_LE(worst.cell.x, 6);
  EXPECT_GE(worst.span, 1);
  EXPECT_GT(worst.value, 1.5);
}

// What one half gains in contrast does not make good what the other loses.
TEST(JudgingDetailLoss, GainsElsewhereDoNotMakeItGood) {
  const auto fault = [](bool gains) {
    return [gains](cv::Mat& frame, int) {
      cv::Mat left = frame.colRange(0, 80), right = frame.colRange(80, 160);
      cv::GaussianBlur(left.clone(), left, {}, 2);
      if (gains) right = (right - cv::Scalar::all(128)) * 1.6 + cv::Scalar::all(128);
    };
  };
  EXPECT_NEAR(detail_loss(made_film(fault(true))).value, detail_loss(made_film(fault(false))).value, 0.15);
}

}  // namespace
}  // namespace freshet::synth::judging
