#include "synth/scene/rendering/cyclic_texture.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "tests/synth/scene/layers/made_layers.h"

namespace freshet::synth::scene {
namespace {

constexpr int kPeriod = 260;

/// Soft clouds that are brighter at the right end than at the left.
cv::Mat sky() {
  cv::Mat out = made_texture({200, 80}, {0.6, 0.5, 0.4}, 0.35f, 4);
  cv::GaussianBlur(out, out, {}, 3);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) out.at<cv::Vec3f>(y, x) *= 0.8f + 0.002f * static_cast<float>(x);
  return out;
}

double steepest(const cv::Mat& texture, int from, int to) {
  double most = 0;
  for (int y = 0; y < texture.rows; ++y)
    for (int x = from; x < to; ++x)
      most = std::max(most, cv::norm(texture.at<cv::Vec3f>(y, x % texture.cols) -
                                     texture.at<cv::Vec3f>(y, (x + 1) % texture.cols)));
  return most;
}

TEST(CyclicTexture, BeginsWithThePictureAndComesRoundWithoutASeam) {
  const cv::Mat picture = sky(), known(picture.size(), CV_8U, cv::Scalar(255));
  const cv::Mat texture = cyclic_texture(picture, known, kPeriod);
  ASSERT_EQ(texture.size(), cv::Size(kPeriod, 80));
  EXPECT_EQ(cv::norm(texture.colRange(0, 200), picture, cv::NORM_INF), 0);
  const double inside = steepest(picture, 0, 199);
  // Where copies meet each other there is a step, softer at a picture's size; none at its ends.
  EXPECT_LT(steepest(texture, 198, 201), 1.5 * inside);
  EXPECT_LT(steepest(texture, kPeriod - 2, kPeriod + 1), 1.5 * inside);
  // What joins the ends is clouds, and no smear.
  cv::Scalar mean, own, joined;
  cv::meanStdDev(picture, mean, own);
  cv::meanStdDev(texture.colRange(205, 255), mean, joined);
  EXPECT_GT(joined[1], 0.5 * own[1]);
}

TEST(CyclicTexture, WhatIsUnknownInThePictureIsFilledToo) {
  const cv::Mat picture = sky();
  cv::Mat known(picture.size(), CV_8U, cv::Scalar(255)), marked = picture.clone();
  const cv::Rect hole(60, 30, 50, 50);
  known(hole).setTo(0);
  marked(hole).setTo(cv::Scalar(0, 0, 5));
  const cv::Mat texture = cyclic_texture(marked, known, kPeriod);
  cv::Mat red;
  cv::extractChannel(texture, red, 2);
  double most = 0;
  cv::minMaxLoc(red, nullptr, &most);
  EXPECT_LT(most, 1);
  cv::Mat found(picture.size(), CV_32FC3, cv::Scalar::all(0));
  texture.colRange(0, 200).copyTo(found, known);
  cv::Mat expected(picture.size(), CV_32FC3, cv::Scalar::all(0));
  picture.copyTo(expected, known);
  EXPECT_EQ(cv::norm(found, expected, cv::NORM_INF), 0);
}

TEST(CyclicTexture, WhereNothingCanBeCopiedItIsSmooth) {
  const cv::Mat picture(5, 20, CV_32FC3, cv::Scalar(0.2, 0.4, 0.6)),
      known(picture.size(), CV_8U, cv::Scalar(255));
  const cv::Mat texture = cyclic_texture(picture, known, 40);
  for (int x = 0; x < 40; ++x) EXPECT_NEAR(texture.at<cv::Vec3f>(2, x)[1], 0.4, 1e-3);
}

TEST(CyclicTexture, IsTheSameForAnyNumberOfThreads) {
  const cv::Mat picture = sky(), known(picture.size(), CV_8U, cv::Scalar(255));
  cv::Mat one;
  {
    const oneapi::tbb::global_control single(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    one = cyclic_texture(picture, known, kPeriod);
  }
  EXPECT_EQ(cv::norm(one, cyclic_texture(picture, known, kPeriod), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace freshet::synth::scene
