#include "synth/outline/dynamic_matte.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "freshet/error.h"

namespace freshet::synth::outline {
namespace {

const cv::Size kSize(120, 90);
constexpr double kFps = 25;

/// A disc with an edge of some pixels.
cv::Mat disc(cv::Point2f middle, float radius) {
  cv::Mat out(kSize, CV_32F);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const float distance = std::hypot(static_cast<float>(x) - middle.x, static_cast<float>(y) - middle.y);
      out.at<float>(y, x) = std::clamp((radius - distance) / 3 + 0.5f, 0.0f, 1.0f);
    }
  return out;
}

cv::Point2d middle_of(const cv::Mat& matte) {
  double sum = 0, x_sum = 0, y_sum = 0;
  for (int y = 0; y < matte.rows; ++y)
    for (int x = 0; x < matte.cols; ++x) {
      const double b = matte.at<float>(y, x);
      sum += b, x_sum += b * x, y_sum += b * y;
    }
  return {x_sum / sum, y_sum / sum};
}

cv::Mat uniform(float u, float v) { return cv::Mat(kSize, CV_32FC2, cv::Scalar(u, v)); }

/// A motion that is different everywhere and in every frame, with sources and sinks.
cv::Mat wild(int frame) {
  cv::Mat out(kSize, CV_32FC2);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const double phase = 0.7 * frame;
      out.at<cv::Vec2f>(y, x) = {static_cast<float>(60 * std::sin(0.11 * y + phase)),
                                 static_cast<float>(-90 + 70 * std::cos(0.09 * x - 0.13 * y + phase))};
    }
  return out;
}

TEST(DynamicMatte, BeginsAsTheStillOne) {
  const cv::Mat alpha = disc({40, 50}, 15);
  EXPECT_EQ(cv::norm(DynamicMatte(alpha, uniform(0, -50), kFps).matte(), alpha, cv::NORM_INF), 0);
}

TEST(DynamicMatte, WithTauOneGoesWhereTheMotionGoes) {
  const cv::Mat alpha = disc({40, 50}, 15);
  DynamicMatte matte(alpha, uniform(50, -25), kFps, {.tau = 1});
  for (int i = 0; i < 15; ++i) matte.step(uniform(50, -25));
  // 15 frames of 2 px and -1 px.
  const cv::Point2d middle = middle_of(matte.matte());
  EXPECT_NEAR(middle.x, 40 + 30, 0.1);
  EXPECT_NEAR(middle.y, 50 - 15, 0.1);
  EXPECT_LT(cv::norm(matte.matte(), disc({70, 35}, 15), cv::NORM_INF), 0.1);
}

TEST(DynamicMatte, WithTauZeroStandsStill) {
  const cv::Mat alpha = disc({40, 50}, 15);
  DynamicMatte matte(alpha, wild(0), kFps, {.tau = 0});
  for (int i = 0; i < 10; ++i) {
    matte.step(wild(i));
    EXPECT_LT(cv::norm(matte.matte(), alpha, cv::NORM_INF), 1e-6);
  }
}

TEST(DynamicMatte, WithoutMotionStandsStill) {
  const cv::Mat alpha = disc({40, 50}, 15);
  DynamicMatte matte(alpha, uniform(0, 0), kFps);
  for (int i = 0; i < 10; ++i) matte.step(uniform(0, 0));
  EXPECT_LT(cv::norm(matte.matte(), alpha, cv::NORM_INF), 1e-3);
}

TEST(DynamicMatte, KeepsItsAreaToAThousandthInAnyMotion) {
  const cv::Mat alpha = disc({60, 50}, 22);
  for (double tau : {0.5, 0.9, 0.97})
    for (bool foot : {false, true}) {
      DynamicMatte matte(alpha, wild(0), kFps, {.tau = tau, .held_foot = foot});
      for (int i = 0; i < 60; ++i) {
        matte.step(wild(i));
        ASSERT_NEAR(cv::sum(matte.matte())[0], matte.area(), 1e-3 * matte.area())
            << "tau " << tau << ", frame " << i;
        double low = 0, high = 0;
        cv::minMaxLoc(matte.matte(), &low, &high);
        ASSERT_GE(low, 0);
        ASSERT_LE(high, 1);
      }
    }
}

TEST(DynamicMatte, EdgesStayAsSoftAsTheyWere) {
  const cv::Mat alpha = disc({60, 60}, 18);
  const auto softness = [](const cv::Mat& b) { return cv::sum(b)[0] - b.dot(b); };
  DynamicMatte kept(alpha, uniform(0, -75), kFps, {.keep_softness = true}),
      spread(alpha, uniform(0, -75), kFps, {.keep_softness = false});
  for (int i = 0; i < 30; ++i) kept.step(uniform(0, -75)), spread.step(uniform(0, -75));
  EXPECT_LT(softness(kept.matte()), 1.05 * softness(alpha));
  EXPECT_GT(softness(spread.matte()), 1.5 * softness(alpha));
}

TEST(DynamicMatte, AFlameStaysOnItsLogs) {
  cv::Mat alpha = cv::Mat::zeros(kSize, CV_32F);
  alpha(cv::Rect(40, 30, 40, 40)).setTo(1);
  DynamicMatte held(alpha, uniform(0, -75), kFps, {.held_foot = true}),
      loose(alpha, uniform(0, -75), kFps, {.held_foot = false});
  for (int i = 0; i < 30; ++i) held.step(uniform(0, -75)), loose.step(uniform(0, -75));
  const cv::Rect foot(42, 66, 36, 3);
  EXPECT_GT(cv::mean(held.matte()(foot))[0], 0.9);
  EXPECT_LT(cv::mean(loose.matte()(foot))[0], 0.3);
}

TEST(DynamicMatte, ThreadsDoNotMatter) {
  const cv::Mat alpha = disc({60, 50}, 22);
  const auto run = [&](std::size_t threads) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    DynamicMatte matte(alpha, wild(0), kFps);
    for (int i = 0; i < 12; ++i) matte.step(wild(i));
    return matte.matte().clone();
  };
  const cv::Mat one = run(1);
  EXPECT_EQ(cv::norm(one, run(2), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(one, run(5), cv::NORM_INF), 0);
}

TEST(DynamicMatte, FluidCarriedOutOfThePictureLeavesNoNonsense) {
  const cv::Mat alpha = disc({60, 20}, 12);
  DynamicMatte matte(alpha, uniform(0, -400), kFps, {.tau = 1});
  for (int i = 0; i < 20; ++i) {
    matte.step(uniform(0, -400));
    EXPECT_TRUE(cv::checkRange(matte.matte(), true, nullptr, 0.0, 1.0 + 1e-6));
  }
}

TEST(DynamicMatte, TauGoesByTimeNotByFrames) {
  const cv::Mat alpha = disc({60, 60}, 18);
  DynamicMatte slow(alpha, uniform(0, -60), 25), fast(alpha, uniform(0, -60), 100);
  for (int i = 0; i < 30; ++i) slow.step(uniform(0, -60));
  for (int i = 0; i < 120; ++i) fast.step(uniform(0, -60));
  EXPECT_NEAR(middle_of(slow.matte()).y, middle_of(fast.matte()).y, 1.5);
}

TEST(DynamicMatte, RefusesATauOutsideItsRange) {
  const cv::Mat alpha = disc({60, 50}, 22);
  for (double tau : {-0.1, 1.1, std::nan("")})
    EXPECT_THROW(DynamicMatte(alpha, uniform(0, 0), kFps, {.tau = tau}), Error) << tau;
}

}  // namespace
}  // namespace freshet::synth::outline
