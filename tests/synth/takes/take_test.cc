#include "synth/takes/take.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace freshet::synth::takes {
namespace {

query::MotionGuide with_speeds() {
  query::MotionGuide guide;
  guide.direction = cv::Mat(4, 4, CV_32FC2, cv::Scalar(0, 1));
  guide.speed = cv::Mat(4, 4, CV_32F, cv::Scalar(200));
  return guide;
}

std::set<std::string> names_of(const std::vector<Take>& takes) {
  std::set<std::string> names;
  for (const Take& take : takes) names.insert(take.name);
  return names;
}

TEST(Take, TheFirstIsAsAskedAndAllDiffer) {
  for (const char* kind : {"water", "fire", "smoke", "clouds", ""}) {
    const std::vector<Take> takes = plan_takes(kind, {}, with_speeds(), {}, kMaxTakes);
    EXPECT_TRUE(takes.front().options.empty());
    EXPECT_EQ(names_of(takes).size(), takes.size()) << kind;
    EXPECT_GE(takes.size(), 5u) << kind;
  }
  EXPECT_EQ(plan_takes("water", {}, {}, {}, 3).size(), 3u);
  EXPECT_EQ(plan_takes("water", {}, {}, {}, 1).size(), 1u);
}

TEST(Take, WhatAPersonSaidIsNotVaried) {
  const Open nothing{.speed = false, .layout = false, .life = false, .method = false};
  EXPECT_EQ(plan_takes("water", {}, {}, nothing, kMaxTakes).size(), 1u);
  const std::vector<Take> layout = plan_takes("water", {}, {}, {.layout = false}, kMaxTakes);
  for (const Take& take : layout) EXPECT_FALSE(take.layout.has_value()) << take.name;
}

TEST(Take, OfOtherMethodsNothingIsVaried) {
  animate::AnimateOptions options;
  options.method = animate::PaperOptions{};
  EXPECT_EQ(plan_takes("water", options, {}, {}, kMaxTakes).size(), 1u);
}

TEST(Take, ALayoutStandsInWaterAndFlamesComeFromClipsInFireAlone) {
  for (const char* kind : {"water", "fire", "smoke", "clouds"})
    for (const Take& take : plan_takes(kind, {}, {}, {}, kMaxTakes)) {
      EXPECT_TRUE(!take.layout || std::string(kind) == "water") << kind;
      EXPECT_TRUE(!take.forms || std::string(kind) == "fire") << kind;
    }
}

TEST(Take, SpeedsThatAreAskedAreScaledAndElseTheClips) {
  animate::AnimateOptions options;
  animate::Playing playing;
  query::MotionGuide asked = with_speeds();
  asked.speed.at<float>(0, 0) = -1;
  apply({.speed = 0.5}, 0, options, asked, playing);
  EXPECT_FLOAT_EQ(asked.speed.at<float>(1, 1), 100);
  EXPECT_LT(asked.speed.at<float>(0, 0), 0);
  EXPECT_EQ(playing.factor, 1);
  query::MotionGuide none;
  apply({.speed = 2}, 0, options, none, playing);
  EXPECT_EQ(playing.factor, 2);
  apply({.own_speeds = true}, 0, options, asked, playing);
  EXPECT_TRUE(asked.speed.empty());
  EXPECT_FALSE(asked.direction.empty());
}

// The guide of the take as asked is not changed by one that scales its speeds.
TEST(Take, CopiesOfAGuideKeepTheirSpeeds) {
  const query::MotionGuide asked = with_speeds();
  query::MotionGuide scaled = asked;
  animate::AnimateOptions options;
  animate::Playing playing;
  apply({.speed = 2}, 0, options, scaled, playing);
  EXPECT_FLOAT_EQ(asked.speed.at<float>(1, 1), 200);
  EXPECT_FLOAT_EQ(scaled.speed.at<float>(1, 1), 400);
}

TEST(Take, LivesAndLayoutsAreThoseOfTheCarriedPicture) {
  animate::AnimateOptions options;
  animate::Playing playing;
  query::MotionGuide asked;
  apply({.layout = animate::Layout::kStands, .life = 0.5}, 0.8, options, asked, playing);
  const auto& carried = std::get<animate::CarriedOptions>(options.method);
  EXPECT_EQ(carried.layout, animate::Layout::kStands);
  EXPECT_DOUBLE_EQ(carried.half_life_s, 0.4);
  apply({.forms = true}, 0.8, options, asked, playing);
  ASSERT_TRUE(std::holds_alternative<animate::FormsOptions>(options.method));
  EXPECT_EQ(std::get<animate::FormsOptions>(options.method).flames, animate::Flames::kClips);
}

TEST(Take, FlamesOfClipsAreNoneOfThoseExcluded) {
  animate::AnimateOptions options;
  options.for_fires->excluded = {"candle.mp4"};
  animate::Playing playing;
  query::MotionGuide asked;
  apply({.forms = true}, 0, options, asked, playing);
  EXPECT_EQ(std::get<animate::FormsOptions>(options.method).excluded, std::vector<std::string>{"candle.mp4"});
}

}  // namespace
}  // namespace freshet::synth::takes
