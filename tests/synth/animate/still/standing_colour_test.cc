#include "synth/animate/still/standing_colour.h"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "synth/animate/still/fluid_planes.h"

namespace freshet::synth::animate {
namespace {

constexpr int kWidth = 96, kHeight = 64;

/// A picture of one colour, and what was carried of it.
struct Still {
  cv::Mat picture{kHeight, kWidth, CV_32FC3, cv::Scalar(0.2, 0.5, 0.8)};
  cv::Mat luma{kHeight, kWidth, CV_32F, cv::Scalar(0.5)};
};

TEST(StandingColour, HoldsTheMeansOfAWideNeighbourhood) {
  const Still still;
  const cv::Mat matte(still.luma.size(), CV_32F, cv::Scalar(1));
  const StandingColour colour(fluid_planes(still.picture, still.luma, matte), matte);
  // A third too light and too blue from left to right, and checks of 2 px about that.
  cv::Mat luma(still.luma.size(), CV_32F);
  CarriedFrame frame{.luma = {},
                     .blue = cv::Mat(kHeight / 2, kWidth / 2, CV_16S),
                     .red = cv::Mat(kHeight / 2, kWidth / 2, CV_16S, cv::Scalar(0.3 * CarriedFrame::kOne)),
                     .fraction = cv::Mat(kHeight / 2, kWidth / 2, CV_16S, cv::Scalar(CarriedFrame::kOne))};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double away = 0.3 * x / kWidth + ((x / 2 + y / 2) % 2 ? 0.05 : -0.05);
      luma.at<float>(y, x) = static_cast<float>(0.5 + away);
      frame.blue.at<std::int16_t>(y / 2, x / 2) =
          static_cast<std::int16_t>((away - 0.3) * CarriedFrame::kOne);
    }
  cv::Mat half = luma.clone();
  colour.hold(half, nullptr, 0.5);
  const double away = cv::mean(luma.colRange(3 * kWidth / 4, kWidth))[0] - 0.5;
  EXPECT_NEAR(cv::mean(half.colRange(3 * kWidth / 4, kWidth))[0] - 0.5, away / 2, 0.01);
  colour.hold(luma, &frame);
  constexpr double kTwoLevels = 2 / 255.0;
  for (int x = 0; x < kWidth; x += kWidth / 4) {
    EXPECT_NEAR(cv::mean(luma.colRange(x, x + kWidth / 4))[0], 0.5, kTwoLevels);
    EXPECT_NEAR(cv::mean(frame.blue.colRange(x / 2, x / 2 + kWidth / 8))[0] / CarriedFrame::kOne, -0.3,
                kTwoLevels);
    EXPECT_NEAR(cv::mean(frame.red.colRange(x / 2, x / 2 + kWidth / 8))[0] / CarriedFrame::kOne, 0.3,
                kTwoLevels);
  }
  // What is small stays.
  EXPECT_NEAR(std::abs(luma.at<float>(20, 40) - luma.at<float>(20, 42)), 0.1, 0.02);
}

TEST(StandingColour, LooksAtTheFluidAlone) {
  const Still still;
  cv::Mat matte(still.luma.size(), CV_32F, cv::Scalar(1));
  matte.colRange(0, kWidth / 2) = 0;
  const StandingColour colour(fluid_planes(still.picture, still.luma, matte), matte);
  cv::Mat luma = still.luma.clone();
  luma.colRange(0, kWidth / 2) = 0;  // no fluid: whatever it holds
  colour.hold(luma, nullptr);
  EXPECT_NEAR(luma.at<float>(30, 60), 0.5, 1e-3);
  EXPECT_NEAR(luma.at<float>(30, kWidth / 2), 0.5, 1e-3);
}

}  // namespace
}  // namespace freshet::synth::animate
