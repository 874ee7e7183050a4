#include "synth/judging/dents.h"

#include <cmath>

#include <gtest/gtest.h>

namespace freshet::synth::judging {
namespace {

const cv::Size kSize(160, 120);

/// Sea of level 90 below a horizon at row 50, sky of level 180 above; copies reach `depth` px into the sea between
/// columns 60 and 90.
Evidence sea(int depth, bool slanted = false) {
  const auto draw = [&](int dent) {
    cv::Mat frame(kSize, CV_8UC3, cv::Scalar::all(180));
    for (int x = 0; x < kSize.width; ++x) {
      const int horizon = 50 + (slanted ? x / 4 : 0) + (x >= 60 && x < 90 ? dent : 0);
      frame.col(x).rowRange(horizon, kSize.height) = cv::Scalar::all(90);
    }
    return frame;
  };
  cv::Mat matte(kSize, CV_8U, cv::Scalar(0));
  for (int x = 0; x < kSize.width; ++x) matte.col(x).rowRange(50 + (slanted ? x / 4 : 0), kSize.height) = 255;
  Evidence film(draw(0), matte, 25);
  for (int i = 0; i < 16; ++i) film.add(draw(i < 8 ? 0 : depth));
  return film;
}

TEST(JudgingDents, AStraightHorizonHasNone) {
  EXPECT_NEAR(dents(sea(0)).value, 0, 1e-6);
  EXPECT_NEAR(dents(sea(0, true)).value, 0, 1e-6);
}

TEST(JudgingDents, ADentIsSeenWithItsDepthAndPlace) {
  const Reading reading = dents(sea(4));
  EXPECT_GT(reading.value, 0.1);
  const Worst worst = worst_of(reading);
  EXPECT_TRUE(worst.cell.x >= 6 && worst.cell.x <= 8) << worst.cell;
  EXPECT_GE(worst.span, 2);
  EXPECT_NEAR(worst.value, 3, 1);  // of 4, the mixed pixels of the border not counted
}

TEST(JudgingDents, WithoutAStraightBorderNothingIsSaid) {
  const cv::Mat still(kSize, CV_8UC3, cv::Scalar::all(100));
  Evidence film(still, cv::Mat(kSize, CV_8U, cv::Scalar(255)), 25);
  for (int i = 0; i < 8; ++i) film.add(still);
  EXPECT_TRUE(std::isnan(dents(film).value));
}

}  // namespace
}  // namespace freshet::synth::judging
