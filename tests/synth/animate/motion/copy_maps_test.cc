#include "synth/animate/motion/copy_maps.h"

#include <cmath>

#include <gtest/gtest.h>

namespace freshet::synth::animate {
namespace {

constexpr int kStep = 4, kThird = 8;
const cv::Size kSize(40, 30);

/// A displacement that changes from frame to frame and is the same everywhere.
cv::Vec2f blown(int i) {
  return {2 + std::sin(0.7f * static_cast<float>(i)), std::cos(0.4f * static_cast<float>(i))};
}
cv::Mat everywhere(int i) {
  const cv::Vec2f v = blown(i);
  return cv::Mat(kSize, CV_32FC2, cv::Scalar(v[0], v[1]));
}

TEST(CopyMaps, SourcesAreTheSumOfTheStepsFromTheCopysOwnFrame) {
  CopyMaps maps(everywhere, kSize, kStep, kThird, 0, false);
  for (int i = 0; i < 5 * kThird; ++i) {
    maps.prepare(i, 1);
    const auto copies = maps.at(i);
    double weights = 0;
    for (const CopyMap& copy : copies) {
      weights += copy.weight;
      if (copy.weight < 1e-3f) continue;
      // Which copy it is, its source in the middle tells: one of those that are alive.
      double nearest = 1e9;
      for (int j = -3; j < 8; ++j) {
        if (2 * std::abs(i - j * kThird) > 3 * kThird) continue;
        cv::Vec2f expected(0, 0);
        const int own = maps.own_frame(j);
        for (int t = own; t < i; ++t) expected -= blown(t);
        for (int t = i; t < own; ++t) expected += blown(t);
        nearest = std::min(nearest, cv::norm(expected - copy.source.at<cv::Vec2f>(15, 20)));
      }
      EXPECT_LT(nearest, 1e-3) << i;
    }
    EXPECT_NEAR(weights, 1, 1e-5) << i;
  }
}

TEST(CopyMaps, AreTheSameWhateverIsPreparedAtOnce) {
  CopyMaps one(everywhere, kSize, kStep, kThird, 0, true), many(everywhere, kSize, kStep, kThird, 0, true);
  many.prepare(0, 40);
  for (int i = 0; i < 40; ++i) {
    one.prepare(i, 1);
    const auto a = one.at(i), b = many.at(i);
    for (int k = 0; k < CopyMaps::kCopies; ++k) {
      EXPECT_EQ(a[k].weight, b[k].weight);
      EXPECT_EQ(cv::norm(a[k].source, b[k].source, cv::NORM_INF), 0);
    }
  }
}

TEST(CopyMaps, TheStillIsLeftWithoutAJump) {
  CopyMaps maps(everywhere, kSize, kStep, kThird, 0, true);
  EXPECT_EQ(maps.still(0), 1);
  EXPECT_EQ(maps.still(kThird), 0);
  for (int i = 1; i <= kThird; ++i) EXPECT_LT(maps.still(i - 1) - maps.still(i), 0.2);
}

TEST(CopyMaps, OwnFramesLieUnevenlySoThatNothingComesAgain) {
  CopyMaps maps(everywhere, kSize, kStep, kThird, 0, true);
  EXPECT_EQ(maps.own_frame(0), 0);
  for (int j = -5; j < 5; ++j) EXPECT_LE(std::abs(maps.own_frame(j) - j * kThird), kThird / 2);
  EXPECT_NE(maps.own_frame(2) - maps.own_frame(1), maps.own_frame(3) - maps.own_frame(2));
}

}  // namespace
}  // namespace freshet::synth::animate
