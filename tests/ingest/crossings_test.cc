#include "ingest/crossings.h"

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "synth/simulate/simulate.h"

namespace freshet::ingest {
namespace {

using synth::simulate::SceneKind;

constexpr int kFrames = 72;

std::vector<cv::Mat> fluid(SceneKind kind, int count = kFrames) {
  synth::simulate::Simulation clip({.kind = kind, .size = {256, 160}, .frames = count, .seed = 4});
  synth::simulate::SimulatedFrame frame;
  std::vector<cv::Mat> frames;
  while (clip.next(frame)) {
    cv::Mat luma;
    cv::cvtColor(frame.picture, luma, cv::COLOR_BGR2GRAY);
    frames.push_back(luma);
  }
  return frames;
}

/// Somebody in light clothes and a dark coat who walks through frames, `step` px in each. path   where they have been.
void walk_through(std::span<cv::Mat> frames, cv::Mat& path, float step = 2, float height = 80) {
  path = cv::Mat::zeros(frames.front().size(), CV_8U);
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const auto time = static_cast<float>(t);
    const cv::Point2f middle(step * time + 20, height + std::sin(0.5f * time));
    cv::ellipse(frames[t], {middle, {20, 48}, 0}, 235, cv::FILLED, cv::LINE_AA);
    cv::ellipse(frames[t], {middle + cv::Point2f(1, -6), {14, 20}, 0}, 25, cv::FILLED, cv::LINE_AA);
    cv::ellipse(path, {middle, {20, 48}, 0}, 255, cv::FILLED);
  }
}

cv::Mat found_in(const std::vector<cv::Mat>& frames, double fps = 25) {
  CrossingFinder finder(frames.front().size(), fps);
  for (const cv::Mat& frame : frames) finder.add(frame);
  return finder.finish();
}

class Crossings : public testing::TestWithParam<SceneKind> {};

TEST_P(Crossings, AreNotSeenInAFluidThatNothingCrosses) { EXPECT_TRUE(found_in(fluid(GetParam())).empty()); }

/// What hides as much as it shows (a river's foam, drops, jets) hides who walks in it too.
class ClearCrossings : public Crossings {};

TEST_P(ClearCrossings, AreFoundWhereSomebodyWalksThrough) {
  std::vector<cv::Mat> frames = fluid(GetParam());
  cv::Mat path, near;
  walk_through(frames, path);
  const cv::Mat found = found_in(frames);
  ASSERT_FALSE(found.empty());
  EXPECT_GT(cv::countNonZero(found & path), 0.7 * cv::countNonZero(path));
  cv::dilate(path, near, cv::Mat::ones(25, 25, CV_8U));
  EXPECT_LT(cv::countNonZero(found & ~near), 0.02 * static_cast<double>(found.total()));
}

std::string name_of(const testing::TestParamInfo<SceneKind>& tested) {
  return std::string(synth::simulate::scene_kind_name(tested.param));
}
INSTANTIATE_TEST_SUITE_P(Of, Crossings,
                         testing::ValuesIn(synth::simulate::all_clip_kinds().begin(),
                                           synth::simulate::all_clip_kinds().end()),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Of, ClearCrossings,
                         testing::Values(SceneKind::kSmoke, SceneKind::kFire, SceneKind::kClouds,
                                         SceneKind::kSea),
                         name_of);

TEST(CrossingFinder, FindsInAnyWindowOfALongClip) {
  const std::vector<cv::Mat> frames = fluid(SceneKind::kClouds, 150);
  EXPECT_TRUE(found_in(frames, 12.5).empty());
  for (const int begin : {0, 50, 90, 120}) {  // the last is in the rest after the last whole window
    std::vector<cv::Mat> crossed;
    for (const cv::Mat& frame : frames) crossed.push_back(frame.clone());
    cv::Mat path;
    walk_through(std::span(crossed).subspan(static_cast<std::size_t>(begin), 30), path, 4);
    const cv::Mat found = found_in(crossed, 12.5);
    ASSERT_FALSE(found.empty()) << begin;
    EXPECT_GT(cv::countNonZero(found & path), 0.6 * cv::countNonZero(path)) << begin;
  }
}

TEST(CrossingFinder, GoesNoFartherThanWhatStopsAtTheBorder) {
  std::vector<cv::Mat> frames = fluid(SceneKind::kClouds);
  cv::Mat path;
  walk_through(std::span(frames).first(40), path, 2, 132);  // their feet at the lower border
  const cv::Mat found = found_in(frames);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(cv::countNonZero(found.colRange(160, 256)), 0);
}

TEST(CrossingFinder, TakesFramesOfAnySize) {
  for (const cv::Size size : {cv::Size(1, 1), {4000, 1}, {1, 3000}, {47, 300}, {48, 48}}) {
    CrossingFinder finder(size, 25);
    for (int t = 0; t < 40; ++t) finder.add(cv::Mat(size, CV_8U, cv::Scalar(t)));
    EXPECT_TRUE(finder.finish().empty()) << size;
  }
}

}  // namespace
}  // namespace freshet::ingest
