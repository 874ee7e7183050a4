#include "synth/scene/frames/pushed_frames.h"

#include <gtest/gtest.h>

namespace freshet::synth::scene {
namespace {

cv::Mat frame_of(int i) { return {2, 3, CV_32FC4, cv::Scalar::all(i)}; }
cv::Mat motion_of(int i) { return {2, 3, CV_32FC2, cv::Scalar::all(100 + i)}; }

/// Motion comes some frames ahead, as renderers make it.
void make(const PushedFrames::Sinks& sinks) {
  for (int i = 0; i < 12; ++i) {
    if (sinks.motion && i % 4 == 0)
      for (int k = i; k < i + 4; ++k) sinks.motion(motion_of(k));
    sinks.frame(frame_of(i));
  }
}

TEST(PushedFrames, EachFrameHasItsMotion) {
  PushedFrames frames(make, FrameWork::kFramesAndMotion);
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(frames.next().at<cv::Vec4f>(0, 0)[0], static_cast<float>(i));
    ASSERT_TRUE(frames.motion());
    EXPECT_EQ(frames.motion()->at<cv::Vec2f>(0, 0)[0], static_cast<float>(100 + i));
  }
}

TEST(PushedFrames, NoMotionIsAskedForWhereNobodyWantsIt) {
  bool asked = true;
  PushedFrames frames([&](const PushedFrames::Sinks& sinks) {
    asked = static_cast<bool>(sinks.motion);
    make(sinks);
  });
  for (int i = 0; i < 12; ++i) frames.next();
  EXPECT_FALSE(asked);
  EXPECT_FALSE(frames.motion());
}

TEST(PushedFrames, AMakerThatKnowsNoMotionLeavesNone) {
  PushedFrames frames([](const PushedFrames::Sinks& sinks) { sinks.frame(frame_of(0)); },
                      FrameWork::kFramesAndMotion);
  frames.next();
  EXPECT_FALSE(frames.motion());
}

}  // namespace
}  // namespace freshet::synth::scene
