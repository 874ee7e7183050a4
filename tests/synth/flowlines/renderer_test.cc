#include "synth/flowlines/renderer.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace freshet::synth::flowlines
