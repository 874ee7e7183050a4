#include "synth/flowlines/renderer.h"

#include <gtest/gtest.h>

#include <cmath>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::flowlines {
namespace {

std::vector<cv::Mat> frames_of(bool sparse) {
  std::vector<cv::Mat> frames;
  cv::RNG random(4);
  for (int t = 0; t < 24; ++t) {
    cv::Mat frame(60, 80, CV_8UC3, cv::Scalar::all(0));
    if (!sparse) random.fill(frame, cv::RNG::UNIFORM, 0, 255);
    for (int i = 0; sparse && i < 3; ++i)
      cv::circle(frame, {random.uniform(0, 80), random.uniform(0, 60)}, 3, cv::Scalar::all(220), cv::FILLED);
    frames.push_back(frame);
  }
  return frames;
}

TEST(Likeness, IsThatOfDenseNoiseSparseLightsAndWhatStands) {
  EXPECT_LT(cv::mean(likeness_of(frames_of(false), 24))[0], 0.1);
  EXPECT_GT(cv::mean(likeness_of(std::vector<cv::Mat>(24, frames_of(false).front()), 24))[0], 0.99);
  EXPECT_GT(cv::mean(likeness_of(frames_of(true), 24))[0], 0.6);
}

double detail(const cv::Mat& picture) {
  cv::Mat laplacian;
  cv::Laplacian(picture, laplacian, CV_32F);
  return cv::mean(cv::abs(laplacian))[0];
}

/// Noise at rest in a frame, unlike from frame to frame, on a ground that is not.
std::vector<cv::Mat> noise_on(double light) {
  std::vector<cv::Mat> frames;
  cv::RNG random(8);
  for (int t = 0; t < 24; ++t) {
    cv::Mat noise(60, 80, CV_16SC3), frame;
    random.fill(noise, cv::RNG::NORMAL, 0, 20);
    noise += cv::Scalar::all(light + 30 * std::sin(t));
    noise.convertTo(frame, CV_8U);
    frames.push_back(frame);
  }
  return frames;
}

TEST(Renderer, GivesBackTheDetailThatAMixCostsAndNothingElse) {
  const std::vector<cv::Mat> frames = noise_on(120);
  Moment half;
  half.add(3, 0.5f);
  half.add(11, 0.5f);
  const std::vector<Moment> moments(frames[0].total(), half);
  const auto shown = [&](Mixing mixing, const std::vector<Moment>& of) {
    Renderer renderer(frames, frames[0].size(), {.mixing = mixing, .likeness = likeness_of(frames, 24)});
    cv::Mat out;
    renderer.render(of, out);
    return out;
  };
  const cv::Mat feathered = shown(Mixing::kFeather, moments), kept = shown(Mixing::kCut, moments);
  const double each = detail(frames[3]);
  EXPECT_LT(detail(feathered), 0.75 * each) << "as printed, a third is lost";
  EXPECT_NEAR(detail(kept) / each, 1, 0.06);
  EXPECT_NEAR(cv::mean(kept)[0], cv::mean(feathered)[0], 0.5) << "how bright it is stays as it was mixed";
  Moment one;
  one.add(5, 1);
  EXPECT_EQ(
      cv::norm(shown(Mixing::kCut, std::vector<Moment>(frames[0].total(), one)), frames[5], cv::NORM_INF), 0);
  // What stands still is alike, and is not sharpened.
  const std::vector<cv::Mat> still(24, frames[0]);
  Renderer renderer(still, still[0].size(), {.likeness = likeness_of(still, 24)});
  cv::Mat out;
  renderer.render(moments, out);
  EXPECT_LE(cv::norm(out, still[0], cv::NORM_INF), 1);
}

}  // namespace
}  // namespace freshet::synth::flowlines
