#include "synth/animate/motion/deformation.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

namespace freshet::synth::animate {
namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr float kMiddle_x = 80, kMiddle_y = 60;

/// Of places right of and below the middle.
cv::Mat flow_of(const std::function<cv::Vec2f(float, float)>& at) {
  cv::Mat out(kHeight, kWidth, CV_32FC2);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      out.at<cv::Vec2f>(y, x) = at(static_cast<float>(x) - kMiddle_x, static_cast<float>(y) - kMiddle_y);
  return out;
}

cv::Mat directions_of(const cv::Mat& of) {
  cv::Mat out = of.clone();
  for (auto& v : cv::Mat_<cv::Vec2f>(out)) {
    const float length = std::hypot(v[0], v[1]);
    if (length > 0) v /= length;
  }
  return out;
}

const cv::Mat kEverywhere(kHeight, kWidth, CV_32F, cv::Scalar(1));

TEST(Deformation, TurningAndGoingAlongDrawNothingOut) {
  const cv::Mat turns = flow_of([](float x, float y) { return cv::Vec2f(3 - 0.2f * y, 0.2f * x - 7); });
  const cv::Rect within(1, 1, kWidth - 2, kHeight - 2);
  EXPECT_LT(cv::norm(strain_rate(turns, 4)(within), cv::NORM_INF), 1e-5);
}

TEST(Deformation, StrainIsThatOfTheFlow) {
  // Sampled every 4 px: slopes by sample are four times those by px.
  const auto in_the_middle = [](const std::function<cv::Vec2f(float, float)>& flow) {
    return strain_rate(flow_of(flow), 4).at<float>(kHeight / 2, kWidth / 2);
  };
  EXPECT_NEAR(in_the_middle([](float, float y) { return cv::Vec2f(0.8f * y, 0); }), 0.1, 1e-5) << "sheared";
  EXPECT_NEAR(in_the_middle([](float x, float y) { return cv::Vec2f(0.8f * x, -0.8f * y); }), 0.2, 1e-5);
  EXPECT_NEAR(in_the_middle([](float x, float y) { return cv::Vec2f(0.8f * x, 0.8f * y); }), 0.2, 1e-5)
      << "all the wider";
}

TEST(Deformation, AVortexIsToldFromBendsAndFromFlowsThatPass) {
  const cv::Mat round = directions_of(flow_of([](float x, float y) { return cv::Vec2f(-y, x); }));
  const cv::Mat other_way = -round;
  const cv::Mat pass = flow_of([](float, float y) { return cv::Vec2f(y < 0 ? 1 : -1, 0); });
  const cv::Mat bends = directions_of(flow_of([](float x, float y) { return cv::Vec2f(-y - 80, x); }));
  EXPECT_GT(vortex(round, kEverywhere), 0.9);
  EXPECT_GT(vortex(other_way, kEverywhere), 0.9);
  EXPECT_LT(vortex(pass, kEverywhere), 0.67);
  const cv::Mat turns_back = directions_of(flow_of(
      [](float x, float y) { return x < 0 ? cv::Vec2f(-y, x) : cv::Vec2f(y < 0 ? 1.0f : -1.0f, 0); }));
  EXPECT_LT(vortex(turns_back, kEverywhere), 0.85);
  EXPECT_LT(vortex(bends, kEverywhere), 0.3);
  EXPECT_LT(vortex(directions_of(flow_of([](float x, float y) { return cv::Vec2f(x, y); })), kEverywhere),
            0.05)
      << "a source";
  EXPECT_EQ(vortex({}, kEverywhere), 0);
}

TEST(Deformation, AVortexBesideTheFluidIsNone) {
  cv::Mat beside = kEverywhere.clone();
  beside.colRange(30, kWidth) = 0;
  EXPECT_LT(vortex(directions_of(flow_of([](float x, float y) { return cv::Vec2f(-y, x); })), beside), 0.3);
}

}  // namespace
}  // namespace freshet::synth::animate
