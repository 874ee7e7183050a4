#include "synth/scene/rendering/calm_water.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>

namespace freshet::synth::scene {
namespace {

constexpr int kHorizon = 40;
const cv::Size kSize(160, 240);
const Line kLevel{{0, kHorizon}, {160, kHorizon}};
constexpr double kCalm = 0.05;

/// What the water mirrors this far below the horizon: a dark shore, trunks that stand upright, and the sky.
cv::Vec3f shore(double x, double below) {
  const double trunks = 0.3 * std::sin(x / 4), sky = below / (below + 60);
  return {static_cast<float>(0.3 + 0.5 * sky + trunks * (1 - sky)), static_cast<float>(0.3 + 0.4 * sky),
          static_cast<float>(0.2 + 0.3 * sky)};
}
/// Ripples whose length and lift grow as the water comes nearer.
cv::Mat lake(double lift) {
  cv::Mat out(kSize, CV_32FC3, cv::Scalar(0, 0, 1));
  for (int y = kHorizon; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const double below = y + 0.5 - kHorizon;
      const double at = below * (1 + lift * std::sin(60 * std::log(below) + 0.2 * std::sin(x / 9.0)));
      out.at<cv::Vec3f>(y, x) = shore(x, at);
    }
  return out;
}
cv::Mat below_horizon() {
  cv::Mat alpha(kSize, CV_32F, cv::Scalar(0));
  alpha.rowRange(kHorizon, kSize.height).setTo(1);
  return alpha;
}
double error(const cv::Mat& picture) {
  const cv::Rect near(0, kHorizon + 40, kSize.width, 130);
  return cv::norm(picture(near), lake(0)(near)) / std::sqrt(3.0 * near.area());
}

TEST(CalmWater, IsNearerToWhatItMirrorsThanRipplesWere) {
  const double rippled = error(lake(0.15));
  EXPECT_GT(rippled, 0.01);
  EXPECT_LT(error(calmed(lake(0.15), below_horizon(), kLevel, kCalm)), 0.35 * rippled);
}

TEST(CalmWater, UprightThingsStaySharpAndNothingElseComesIn) {
  const cv::Mat still = lake(0), calm = calmed(still, below_horizon(), kLevel, kCalm);
  EXPECT_LT(error(calm), 0.004) << "calm water is as it was";
  EXPECT_LT(cv::norm(calm.rowRange(0, kHorizon), still.rowRange(0, kHorizon), cv::NORM_INF), 1e-6);
  cv::Mat before_bank = still.clone(), alpha = below_horizon();
  before_bank.rowRange(200, kSize.height).setTo(cv::Scalar(0, 0, 1));
  alpha.rowRange(200, kSize.height).setTo(0);
  EXPECT_LT(calmed(before_bank, alpha, kLevel, kCalm).at<cv::Vec3f>(199, 80)[2], 0.45f)
      << "half red with the bank";
}

TEST(CalmWater, SmoothsTheMoreTheNearerItIsAndByTheHorizonAsItLies) {
  cv::Mat steps(kSize, CV_32FC3, cv::Scalar::all(0));
  for (const int y : {90, 210}) steps.rowRange(y, y + 1).setTo(cv::Scalar::all(1));
  const cv::Mat all(kSize, CV_32F, cv::Scalar(1));
  const auto height = [](const cv::Mat& picture, int y, int x) { return picture.at<cv::Vec3f>(y, x)[0]; };
  // A line of one pixel is as high as 1 / (sigma sqrt(2 pi)).
  const cv::Mat level = calmed(steps, all, kLevel, kCalm);
  EXPECT_NEAR(height(level, 90, 80), 1 / (kCalm * 50.5 * 2.507), 0.01);
  EXPECT_NEAR(height(level, 210, 80), 1 / (kCalm * 170.5 * 2.507), 0.005);
  const cv::Mat tilted = calmed(steps, all, {{0, 0}, {160, 80}}, kCalm);
  EXPECT_NEAR(height(tilted, 90, 40), 1 / (kCalm * 70.25 * 2.507), 0.01);
  EXPECT_EQ(cv::norm(calmed(steps, all, kLevel, 0), steps, cv::NORM_INF), 0);
}

TEST(CalmWater, IsTheSameForAnyNumberOfThreads) {
  const cv::Mat many = calmed(lake(0.15), below_horizon(), kLevel, kCalm);
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(cv::norm(calmed(lake(0.15), below_horizon(), kLevel, kCalm), many, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace freshet::synth::scene
