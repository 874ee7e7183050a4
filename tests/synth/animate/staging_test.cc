#include "synth/animate/staging.h"

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "tests/synth/animate/flowing_clip.h"

namespace freshet::synth::animate {
namespace {

const cv::Size kPicture(144, 100);

class Staged : public testing::Test {
 protected:
  Staging staged(const Playing& playing) const {
    query::Assignment assignment;
    assignment.picture = kPicture;
    assignment.clips = {
        {.name = "0.mkv", .class_name = "water", .licence = "", .source_hash = "hash of 0.mkv"}};
    for (const int x : {0, 24, 48, 72})
      assignment.pieces.push_back({.corner = {x, 0}, .clip = 0, .variant = {}, .patch = {x, 0}, .score = 1});
    query::MotionGuide asked;
    asked.direction = cv::Mat(kPicture, CV_32FC2, cv::Scalar(1, 0));
    asked.speed = cv::Mat(kPicture, CV_32F, cv::Scalar(80));
    AnimateOptions options;
    options.frames = 7;
    return stage(store_.snapshot(), assignment, kPicture, asked, playing, options);
  }

 private:
  FlowingStore store_{{FlowingClip{.frames = 4}}};
};

TEST_F(Staged, AsFilmedTheMotionIsAskedWithItsSpeeds) {
  const Staging staging = staged({});
  EXPECT_EQ(staging.options.frames, 7);
  ASSERT_EQ(staging.placement.patches.size(), 4u);
  for (const PlacedPatch& patch : staging.placement.patches) EXPECT_EQ(patch.speed, 1);
  EXPECT_FALSE(staging.options.guide.direction.empty());
  EXPECT_FALSE(staging.options.guide.speed.empty());
}

TEST_F(Staged, RetimedPatchesGoAsFastAsTheyPlay) {
  const Staging staging = staged({.factor = 0.5});
  for (const PlacedPatch& patch : staging.placement.patches) EXPECT_EQ(patch.speed, 0.5);
  EXPECT_FALSE(staging.options.guide.direction.empty());
  EXPECT_TRUE(staging.options.guide.speed.empty());
}

TEST_F(Staged, OneRetimedPatchIsEnough) {
  cv::Mat map(kPicture, CV_8UC3, cv::Scalar::all(128));
  map(cv::Rect(84, 0, 60, 100)).setTo(cv::Scalar::all(255));
  const Staging staging = staged({.factor = 1, .map = map});
  EXPECT_EQ(staging.placement.patches.front().speed, 1);
  EXPECT_EQ(staging.placement.patches.back().speed, 2);
  EXPECT_TRUE(staging.options.guide.speed.empty());
}

TEST_F(Staged, AMapOfAnotherSizeIsRefused) {
  EXPECT_THROW(staged({.factor = 1, .map = cv::Mat(10, 10, CV_8UC3, cv::Scalar::all(128))}), Error);
}

}  // namespace
}  // namespace freshet::synth::animate
