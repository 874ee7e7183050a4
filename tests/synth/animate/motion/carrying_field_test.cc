#include "synth/animate/motion/carrying_field.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/synth/animate/flowing_clip.h"

namespace freshet::synth::animate {
namespace {

constexpr double kFps = 25;
constexpr int kStep = 4, kFrames = 19;
const cv::Size kPicture(100, 70);

/// A clip that flows by (2, -1) px a frame and varies about it, laid over the whole picture. shift: px of the clip that
/// lie between neighbouring patches, 24 as pieces do.
std::shared_ptr<const MotionSequence> sequence_of(const FlowingStore& store, int frames = kFrames,
                                                  int shift = 24) {
  Placement placement{.side = 48, .stride = 24, .patches = {}};
  PlayedPatches played{.clip = store.id(), .patches = {}, .shown = {}};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 5; ++column) {
      played.patches.push_back(placement.patches.size());
      placement.patches.push_back({.piece = {24 * column - 8, 24 * row - 8},
                                   .clip = store.id(),
                                   .variant = {},
                                   .patch = cv::Point(shift * column + 8, shift * row + 8)});
    }
  for (int i = 0; i < frames; ++i)
    played.shown.push_back({.frame = static_cast<std::uint32_t>(i), .rate = 1});
  MotionSums sums(store.snapshot(), store.settings(), placement, kPicture, frames);
  sums.add(played);
  return std::make_shared<const MotionSequence>(std::move(sums).means());
}

const FlowingClip kClip{.size = {220, 180}, .steady = {2.0f, -1.0f}, .varying = 0.6f};

cv::Mat asked(float u, float v) { return cv::Mat(kPicture, CV_32FC2, cv::Scalar(u, v)); }

TEST(CarryingField, GoesOnAverageAsAsked) {
  const FlowingStore store({kClip});
  const CarryingField field(sequence_of(store), asked(-10, 60), kFrames, kFps, kStep, false, {});
  cv::Mat mean = cv::Mat::zeros(field.size(), CV_32FC2);
  for (int i = 0; i < kFrames; ++i) mean += field.at(i) / kFrames;
  for (int y = 0; y < mean.rows; ++y)
    for (int x = 0; x < mean.cols; ++x) {
      EXPECT_NEAR(mean.at<cv::Vec2f>(y, x)[0], -10 / kFps, 0.1);
      EXPECT_NEAR(mean.at<cv::Vec2f>(y, x)[1], 60 / kFps, 0.1);
    }
}

TEST(CarryingField, VariesAsThePatchesDoTurnedAndScaledAsTheirMeanIs) {
  const FlowingStore store({kClip});
  const auto sequence = sequence_of(store);
  // The assigned mean is (50, -25) px/s: asked is it turned by a quarter and doubled, so fluctuations are too.
  const CarryingField field(sequence, asked(50, 100), kFrames, kFps, kStep, false, {.max_regain = 1});
  cv::Mat mean = cv::Mat::zeros(field.size(), CV_32FC2);
  for (int i = 0; i < kFrames; ++i) mean += sequence->at(i, kStep, field.size()) / kFrames;
  const cv::Point middle(field.size().width / 2, field.size().height / 2);
  for (const int i : {0, 7, 18}) {
    const cv::Vec2f d =
        sequence->at(i, kStep, field.size()).at<cv::Vec2f>(middle) - mean.at<cv::Vec2f>(middle);
    const cv::Vec2f expected = cv::Vec2f(50 - 2 * d[1], 100 + 2 * d[0]) / static_cast<float>(kFps);
    const cv::Vec2f found = field.at(i).at<cv::Vec2f>(middle);
    EXPECT_LT(cv::norm(found - expected), 0.1) << i;
  }
}

/// By how much a place's motion differs from frame to frame, over the patches'; row 8 of the field.
double varies(const MotionSequence& sequence, const CarryingField& field, int x) {
  double found = 0, own = 0;
  const auto apart = [&](const cv::Mat& one, const cv::Mat& next) {
    return cv::norm(one.at<cv::Vec2f>(8, x) - next.at<cv::Vec2f>(8, x));
  };
  for (int i = 0; i + 1 < kFrames; ++i) {
    found += kFps * apart(field.at(i), field.at(i + 1));
    own += apart(sequence.at(i, kStep, field.size()), sequence.at(i + 1, kStep, field.size()));
  }
  return found / own;
}

TEST(CarryingField, WhatMixingTakesOfThePatchesOwnMotionIsGivenBack) {
  const FlowingStore store({{.size = {400, 300}, .steady = {2.0f, -1.0f}, .varying = 0.6f}});
  const auto found = [&](const std::shared_ptr<const MotionSequence>& sequence, double most) {
    const CarryingField field(sequence, asked(50, -25), kFrames, kFps, kStep, false,
                              {.max_regain = most, .max_of_asked = 0});
    return varies(*sequence, field, 12);
  };
  const auto in_step = sequence_of(store), out_of_step = sequence_of(store, kFrames, 48);
  EXPECT_NEAR(found(out_of_step, 1), 1, 0.1);
  EXPECT_GT(found(out_of_step, 2), 1.6);
  EXPECT_NEAR(found(out_of_step, 1.2), 1.2, 0.1);
  EXPECT_LT(found(in_step, 2), 1.3);  // what is lost by smoothing
}

TEST(CarryingField, WhatPatchesDoTogetherIsNotGivenBack) {
  FlowingClip clip{.size = {400, 300}, .steady = {2.0f, -1.0f}, .varying = 0.3f};
  clip.rates.assign(19, kFps);
  for (int i = 0; i < 19; ++i)
    if (i % 6 < 2) clip.rates[static_cast<std::size_t>(i)] = 1;  // all but stands
  const FlowingStore store({clip});
  const auto sequence = sequence_of(store, kFrames, 48);
  const CarryingField field(sequence, asked(50, -25), kFrames, kFps, kStep, false, {.max_of_asked = 0});
  double least = 1;
  for (int i = 0; i < kFrames; ++i) least = std::min(least, cv::mean(field.at(i))[0]);
  EXPECT_NEAR(least, 0, 0.3);  // and does not go back
}

TEST(CarryingField, FlamesLeapAsTheirPatchesHoweverSlowlyTheyAreToRiseAndStandWhereTheyAreTo) {
  for (const float steady : {2.0f, 0.0f}) {
    const FlowingStore store({{.size = {220, 180}, .steady = {steady, -steady / 2}, .varying = 0.6f}});
    const auto sequence = sequence_of(store);
    cv::Mat slow = asked(4, 0);
    slow.colRange(0, 30).setTo(0);
    slow.colRange(60, 80).setTo(cv::Scalar(0.1, 0));  // a stroke of speed 0
    const CarryingField field(sequence, slow, kFrames, kFps, kStep, false, {.least_scale = 1});
    EXPECT_LT(varies(*sequence, field, 2), 0.05);
    EXPECT_LT(varies(*sequence, field, 17), 0.05);
    if (steady == 0) continue;
    EXPECT_NEAR(varies(*sequence, field, 24), 1, 0.2);
    EXPECT_LT(varies(*sequence, {sequence, slow, kFrames, kFps, kStep, false, {}}, 24), 0.2);
  }
}

TEST(CarryingField, FlamesAreNotTornWhereTheyAreToGoOpposingWays) {
  const FlowingStore store({kClip});
  cv::Mat opposed = asked(-20, 0);
  opposed.colRange(50, 100).setTo(cv::Scalar(20, 0));
  const CarryingField field(sequence_of(store), opposed, kFrames, kFps, kStep, false,
                            {.variation = 1, .max_of_asked = 0, .least_scale = 1});
  const CarryingField steady(sequence_of(store), opposed, kFrames, kFps, kStep, false, {.variation = 0});
  for (int i = 0; i < kFrames; ++i) {
    const cv::Mat varies = field.at(i) - steady.at(i);
    for (int x = 1; x < varies.cols; ++x)
      EXPECT_LT(cv::norm(varies.at<cv::Vec2f>(8, x) - varies.at<cv::Vec2f>(8, x - 1)), 0.65) << i << " " << x;
  }
}

TEST(CarryingField, WithoutVariationIsSteady) {
  const FlowingStore store({kClip});
  const CarryingField field(sequence_of(store), asked(30, 0), kFrames, kFps, kStep, false, {.variation = 0});
  EXPECT_LT(cv::norm(field.at(0), field.at(9), cv::NORM_INF), 1e-6);
}

TEST(CarryingField, ALoopGoesRoundAndOtherwiseTheEndsGoOn) {
  const FlowingStore store({kClip});
  const auto sequence = sequence_of(store);
  const CarryingField round(sequence, asked(30, 0), kFrames, kFps, kStep, true, {});
  const CarryingField open(sequence, asked(30, 0), kFrames, kFps, kStep, false, {});
  EXPECT_EQ(cv::norm(round.at(-1), round.at(kFrames - 1), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(round.at(kFrames + 2), round.at(2), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(open.at(-3), open.at(0), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace freshet::synth::animate
