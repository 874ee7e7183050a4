#include "synth/flowlines/jumps/fading.h"

#include <gtest/gtest.h>

namespace freshet::synth::flowlines {
namespace {

const cv::Size kCells(5, 4);
const cv::Rect kAll({0, 0}, kCells);

/// Frame t is grey level t on its left, and stands still on its right.
std::vector<cv::Mat> ramps(int count) {
  std::vector<cv::Mat> frames;
  for (int t = 0; t < count; ++t) {
    frames.emplace_back(16, 20, CV_8UC3, cv::Scalar::all(t));
    frames.back().colRange(12, 20).setTo(40);
  }
  return frames;
}

cv::Mat at_once() { return cv::Mat(kCells, CV_32F, cv::Scalar(0)); }

TEST(Fading, ChangesNoFasterThanTheClip) {
  const std::vector<cv::Mat> frames = ramps(60);
  const Fading fading(frames, kCells);
  const cv::Mat fades = fading.of(kAll, at_once(), at_once(), {.leaves = 26, .enters = 20, .most = 16});
  EXPECT_FLOAT_EQ(fades.at<float>(2, 0), 6 * static_cast<float>(kSlower)) << "6 levels apart, 1 a frame";
  EXPECT_FLOAT_EQ(fades.at<float>(2, 4), 1) << "alike";
}

TEST(Fading, KeepsWithinItsFramesAndTheClip) {
  const std::vector<cv::Mat> frames = ramps(60);
  const Fading fading(frames, kCells);
  const auto fade = [&](const Jump& jump, float arrival, float away) {
    const cv::Mat over(kCells, CV_32F, cv::Scalar(static_cast<double>(arrival)));
    const cv::Mat from_front(kCells, CV_32F, cv::Scalar(static_cast<double>(away)));
    return fading.of(kAll, over, from_front, jump).at<float>(2, 0);
  };
  EXPECT_FLOAT_EQ(fade({.leaves = 40, .enters = 15, .most = 12}, 0, 0), 12) << "other jumps are near";
  EXPECT_FLOAT_EQ(fade({.leaves = 40, .enters = 15, .most = 12}, 0, -3), 9) << "3 of them are gone";
  EXPECT_FLOAT_EQ(fade({.leaves = 40, .enters = 5, .most = 16}, 0, 0), 5) << "the clip begins";
  EXPECT_FLOAT_EQ(fade({.leaves = 40, .enters = 5, .most = 16}, 4, 0), 9) << "later on it has begun";
  EXPECT_FLOAT_EQ(fade({.leaves = 50, .enters = 20, .most = 16}, 2, 0), 7) << "the clip ends";
}

/// Stripes a pixel wide, which half the frames show a pixel further: reduced, they are all the same grey.
TEST(Fading, SeesWhatAReducedPictureDoesNot) {
  std::vector<cv::Mat> frames;
  for (int t = 0; t < 40; ++t) {
    frames.emplace_back(16, 20, CV_8UC3, cv::Scalar::all(0));
    for (int x = t < 20 ? 0 : 1; x < 20; x += 2) frames.back().col(x).setTo(cv::Scalar::all(60));
  }
  const cv::Mat fades =
      Fading(frames, kCells).of(kAll, at_once(), at_once(), {.leaves = 25, .enters = 14, .most = 10});
  EXPECT_GE(fades.at<float>(2, 2), 10);
}

}  // namespace
}  // namespace freshet::synth::flowlines
