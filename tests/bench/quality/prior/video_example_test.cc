#include "bench/quality/prior/video_example.h"

#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::bench {
namespace {

const cv::Size kClip(128, 96);

cv::Mat noise(cv::Size size, std::uint64_t seed) {
  cv::Mat values(size, CV_8U), grey;
  cv::RNG(seed).fill(values, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(values, values, {}, 2);
  cv::merge(std::vector{values, values, values}, grey);
  return grey;
}
cv::Mat all_fluid() { return cv::Mat(kClip, CV_8U, cv::Scalar(255)); }
cv::Mat going(float u, float v) { return cv::Mat(kClip, CV_32FC2, cv::Scalar(u, v)); }
double grey_apart(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total() * 3);
}
double deviation_of(const cv::Mat& values) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(values, mean, deviation);
  return deviation[0];
}
/// Texture that goes right by 2 px a frame.
std::vector<cv::Mat> drifting(int frames) {
  const cv::Mat wide = noise({kClip.width + 2 * frames, kClip.height}, 3);
  std::vector<cv::Mat> clip;
  for (int t = 0; t < frames; ++t)
    clip.push_back(wide(cv::Rect(2 * (frames - 1 - t), 0, kClip.width, kClip.height)).clone());
  return clip;
}
std::vector<cv::Mat> flickering(int frames, const cv::Rect& where) {
  std::vector<cv::Mat> clip;
  for (int t = 0; t < frames; ++t) {
    clip.emplace_back(kClip, CV_8UC3, cv::Scalar::all(128));
    noise(where.size(), 100 + t).copyTo(clip.back()(where));
  }
  return clip;
}

TEST(VideoExample, WhatTheFlowExplainsIsNoResidual) {
  const std::vector<cv::Mat> clip = drifting(40);
  const VideoExample right = decompose(clip, going(2, 0)), none = decompose(clip, going(0, 0));
  ASSERT_EQ(right.residuals.size(), 39u);
  EXPECT_GT(right.kept, 0.97);
  EXPECT_LT(none.kept, 0.97);
  const cv::Rect inner(8, 8, 112, 80);
  EXPECT_LT(deviation_of(right.residuals[20](inner)), 0.2 * deviation_of(none.residuals[20](inner)));
}

TEST(VideoExample, WhereNothingFlowsOrFlickersItIsTheStill) {
  const cv::Mat still = noise(kClip, 9);
  const VideoExample standing = decompose(std::vector(5, noise(kClip, 2)), going(0, 0));
  const std::vector<cv::Mat> made = animate_by_example(still, all_fluid(), going(0, 0), 25, standing, 6);
  ASSERT_EQ(made.size(), 6u);
  EXPECT_EQ(grey_apart(made[0], still), 0);
  for (const cv::Mat& frame : made) EXPECT_LT(grey_apart(frame, still), 1);
}

TEST(VideoExample, DetailGoesWhereItIsAsked) {
  const cv::Mat still = noise(kClip, 9);
  const VideoExample standing = decompose(std::vector(5, noise(kClip, 2)), going(0, 0));
  const std::vector<cv::Mat> made = animate_by_example(still, all_fluid(), going(0, 50), 25, standing, 6);
  // 2 px a frame downwards, of which the still's finest 32 px are differences from its long exposure.
  const cv::Rect middle(16, 24, 96, 56);
  for (int t = 1; t < 6; ++t) {
    const double right = grey_apart(made[t](middle), still(middle - cv::Point(0, 2 * t))),
                 stood = grey_apart(made[t](middle), still(middle));
    EXPECT_LT(right, 0.7 * stood) << t;
  }
}

TEST(VideoExample, ResidualsComeFromWhatLooksAlike) {
  // The right half of the example flickers and is as grey as the still, the left is black and stands.
  std::vector<cv::Mat> clip = flickering(24, {64, 0, 64, 96});
  for (cv::Mat& frame : clip) frame(cv::Rect(0, 0, 64, 96)) = 0;
  cv::Mat still(kClip, CV_8UC3, cv::Scalar::all(0));
  still(cv::Rect(0, 0, 64, 96)) = noise({64, 96}, 9) / 4 + cv::Scalar::all(96);
  const VideoExample example = decompose(clip, going(0, 0));
  const std::vector<cv::Mat> made = animate_by_example(still, all_fluid(), going(0, 0), 25, example, 12);
  cv::Mat grey_changes, black_changes;
  cv::absdiff(made[11](cv::Rect(0, 0, 32, 96)), made[10](cv::Rect(0, 0, 32, 96)), grey_changes);
  cv::absdiff(made[11](cv::Rect(96, 0, 32, 96)), made[10](cv::Rect(96, 0, 32, 96)), black_changes);
  EXPECT_GT(cv::mean(grey_changes)[0], 10 * cv::mean(black_changes)[0] + 0.1);
}

/// It changes by more downwards than across.
void expect_level_stripes(const cv::Mat& shown) {
  cv::Mat frame, across, along;
  shown.convertTo(frame, CV_32F);
  cv::Sobel(frame, across, CV_32F, 1, 0);
  cv::Sobel(frame, along, CV_32F, 0, 1);
  EXPECT_GT(cv::norm(along), 1.5 * cv::norm(across));
}

TEST(VideoExample, ResidualsTurnWithTheFlow) {
  // Stripes that come and go, across a flow to the right: in a still that flows down they lie across that.
  std::vector<cv::Mat> clip;
  for (int t = 0; t < 24; ++t) {
    cv::Mat frame(kClip, CV_8UC3);
    for (int x = 0; x < kClip.width; ++x)
      frame.col(x) = cv::Scalar::all(128 + 60 * std::sin(0.6 * x) * std::sin(2.1 * t));
    clip.push_back(frame);
  }
  const VideoExample example = decompose(clip, going(1, 0));
  const cv::Mat still = noise(kClip, 9) / 8 + cv::Scalar::all(112);
  const std::vector<cv::Mat> made = animate_by_example(still, all_fluid(), going(0, 25), 25, example, 8);
  expect_level_stripes(made[6]);
}

TEST(VideoExample, ResidualsComeFromWhatFlowsAsFast) {
  // Both halves come and go as strongly: the left, which stands, in upright stripes, the right, which flows, in level
  // ones.
  std::vector<cv::Mat> clip;
  for (int t = 0; t < 24; ++t) {
    clip.emplace_back(kClip, CV_8UC3);
    for (int y = 0; y < kClip.height; ++y)
      for (int x = 0; x < kClip.width; ++x)
        clip.back().at<cv::Vec3b>(y, x) = cv::Vec3b::all(
            static_cast<std::uint8_t>(128 + 60 * std::sin(0.6 * (x < 64 ? x : y)) * std::sin(2.1 * t)));
  }
  cv::Mat flow = going(4, 0);
  flow.colRange(0, 64) = cv::Scalar::all(0);
  const std::vector<cv::Mat> made = animate_by_example(
      noise(kClip, 9) / 8 + cv::Scalar::all(112), all_fluid(), going(100, 0), 25, decompose(clip, flow), 8);
  expect_level_stripes(made[6]);
}

TEST(VideoExample, DetailLivesAsLongAsTheExamplesAndIsAsStrongAsTheStills) {
  // Each frame of the example is another: its differences are forgotten at once.
  const VideoExample example = decompose(flickering(24, {{}, kClip}), going(0, 0));
  EXPECT_LT(example.kept, 0.05);
  const cv::Mat still = noise(kClip, 9) / 8 + cv::Scalar::all(112);
  const std::vector<cv::Mat> made = animate_by_example(still, all_fluid(), going(0, 0), 25, example, 12);
  EXPECT_LT(deviation_of(made[11]), 1.5 * deviation_of(still));
  // Changes one after the other then share a frame (-.5). If differences were kept for ever, they would share nothing.
  cv::Mat first, second, frames[3];
  for (int i = 0; i < 3; ++i) made[9 + i].convertTo(frames[i], CV_32F);
  first = frames[1] - frames[0];
  second = frames[2] - frames[1];
  EXPECT_LT(first.dot(second) / (cv::norm(first) * cv::norm(second)), -0.25);
}

TEST(VideoExample, NoPlaceOfTheExampleIsShownSideBySide) {
  const cv::Mat still = noise(kClip, 9) / 16 + cv::Scalar::all(120);
  const std::vector<cv::Mat> made = animate_by_example(
      still, all_fluid(), going(0, 0), 25, decompose(flickering(24, {{}, kClip}), going(0, 0)), 4);
  cv::Mat change, left, right;
  cv::subtract(made[3], made[2], change, cv::noArray(), CV_32F);
  left = change.colRange(0, kClip.width - 16);
  right = change.colRange(16, kClip.width);
  EXPECT_LT(left.dot(right) / (cv::norm(left) * cv::norm(right)), 0.15);
}

TEST(VideoExample, ABrokenOffExampleBeginsAgainAndContrastDoesNotGrow) {
  const cv::Mat still = noise(kClip, 9);
  const std::vector<cv::Mat> made =
      animate_by_example(still, all_fluid(), going(30, 0), 25, decompose(drifting(10), going(2, 0)), 40);
  EXPECT_NEAR(deviation_of(made[39]) / deviation_of(still), 1, 0.3);
  EXPECT_GT(grey_apart(made[39], made[38]), 0.5);
}

TEST(VideoExample, OutsideTheMatteIsTheStillAndThreadsChangeNothing) {
  const cv::Mat still = noise(kClip, 9);
  cv::Mat matte = all_fluid();
  matte(cv::Rect(0, 0, 48, 96)) = 0;
  const auto last = [&] {
    return animate_by_example(still, matte, going(30, 0), 25, decompose(drifting(10), going(2, 0)), 5).back();
  };
  const cv::Mat all = last();
  EXPECT_EQ(grey_apart(all.colRange(0, 48), still.colRange(0, 48)), 0);
  EXPECT_GT(grey_apart(all.colRange(64, 128), still.colRange(64, 128)), 2);
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(grey_apart(all, last()), 0);
}

}  // namespace
}  // namespace freshet::bench
