#include "synth/transfer/files/fine_drawing.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "synth/transfer/pixel_grid.h"

namespace freshet::synth::transfer {
namespace {

constexpr int kSide = 96;

TargetFrame design(const cv::Rect& fluid) {
  TargetFrame target{cv::Mat(kSide, kSide, CV_8U, cv::Scalar(0)),
                     cv::Mat(kSide, kSide, CV_32FC2, cv::Scalar::all(0))};
  target.alpha(fluid).setTo(255);
  return target;
}

TEST(FineDrawing, LeavesWhatIsLargeAlone) {
  const cv::Mat drawing = fine_drawing(design({20, 20, 56, 56}), {});
  EXPECT_FLOAT_EQ(drawing.at<float>(48, 48), 1);   // inside
  EXPECT_NEAR(drawing.at<float>(48, 20), 1, 0.2);  // its outline is the exemplar's
  EXPECT_NEAR(drawing.at<float>(48, 19), 1, 0.2);
  EXPECT_FLOAT_EQ(drawing.at<float>(2, 2), 1);
}

TEST(FineDrawing, AThreadIsBrightAndWhatTheBlurPutBesideItIsDark) {
  const cv::Mat drawing = fine_drawing(design({46, 10, 3, 76}), {});
  EXPECT_GT(drawing.at<float>(48, 47), 2);
  EXPECT_LT(drawing.at<float>(48, 43), 0.4);
  EXPECT_LT(drawing.at<float>(48, 51), 0.4);
}

TEST(FineDrawing, ANarrowGapIsDarkButNotBlack) {
  TargetFrame target = design({10, 10, 76, 76});
  target.alpha(cv::Rect(47, 10, 2, 76)).setTo(0);
  const cv::Mat drawing = fine_drawing(target, {});
  EXPECT_LT(drawing.at<float>(48, 47), 0.6);
  EXPECT_GT(drawing.at<float>(48, 47), 0.4);
  EXPECT_GT(drawing.at<float>(48, 44), 1);
}

TEST(FineDrawing, IsBlurredAlongTheMotionAsTheFrameIs) {
  TargetFrame target = design({46, 10, 3, 76});
  target.flow.setTo(cv::Scalar(12, 0));
  const cv::Mat sharp = fine_drawing(target, {}), blurred = fine_drawing(target, {.motion_blur = 1});
  EXPECT_LT(blurred.at<float>(48, 47), sharp.at<float>(48, 47) - 0.5f);
  EXPECT_GT(blurred.at<float>(48, 43), sharp.at<float>(48, 43) + 0.2f);
}

TEST(FineDrawing, IsTheSameForAnyNumberOfThreads) {
  cv::RNG random(7);
  TargetFrame target = design({0, 0, kSide, kSide});
  random.fill(target.alpha, cv::RNG::UNIFORM, 0, 256);
  const auto with = [&](std::size_t threads) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    return fine_drawing(target, {.motion_blur = 0.5});
  };
  EXPECT_EQ(cv::norm(with(1), with(4), cv::NORM_INF), 0);
}

TEST(FineDrawing, ScalesTheAlphaOfLightAndKeepsItsColour) {
  cv::Mat light(1, 2, CV_32FC4);
  light.at<cv::Vec4f>(0, 0) = {0.1f, 0.5f, 1, 0.3f};
  light.at<cv::Vec4f>(0, 1) = {0.1f, 0.5f, 1, 0.8f};
  draw_light(cv::Mat(1, 2, CV_32F, cv::Scalar(2)), light);
  EXPECT_EQ(light.at<cv::Vec4f>(0, 0), cv::Vec4f(0.1f, 0.5f, 1, 0.6f));
  EXPECT_EQ(light.at<cv::Vec4f>(0, 1), cv::Vec4f(0.1f, 0.5f, 1, 1));
}

}  // namespace
}  // namespace freshet::synth::transfer
