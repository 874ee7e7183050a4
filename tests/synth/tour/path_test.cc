#include "synth/tour/path.h"

#include <cmath>

#include <gtest/gtest.h>

namespace freshet::synth::tour {
namespace {

std::vector<PathKey> keys() {
  return {{0, {.position = {0, 0, 0}, .view_deg = 50}},
          {1, {.position = {0.5, 0.2, 1}, .yaw_deg = 10, .view_deg = 50}},
          {3, {.position = {0.5, 0.1, 2}, .yaw_deg = -5, .view_deg = 40}},
          {4, {.position = {0.4, 0.1, 4}, .yaw_deg = -5, .view_deg = 40}}};
}

TEST(TourPath, GoesThroughItsKeysAndRestsBeyondThem) {
  for (const bool eased : {false, true}) {
    const Path path(keys(), eased);
    for (const PathKey& key : keys()) {
      EXPECT_LT(cv::norm(path.at(key.time_s).position - key.place.position), 1e-12);
      EXPECT_NEAR(path.at(key.time_s).yaw_deg, key.place.yaw_deg, 1e-12);
    }
    EXPECT_EQ(path.at(-1).position, keys().front().place.position);
    EXPECT_EQ(path.at(9).position, keys().back().place.position);
  }
}

TEST(TourPath, BetweenTwoKeysNothingLeavesTheirRange) {
  const Path path(keys(), false);
  for (std::size_t i = 0; i + 1 < keys().size(); ++i)
    for (double t = 0; t <= 1; t += 0.01) {
      const PathKey a = keys()[i], b = keys()[i + 1];
      const CameraPlace at = path.at(a.time_s + t * (b.time_s - a.time_s));
      for (int c = 0; c < 3; ++c) {
        EXPECT_GE(at.position[c], std::min(a.place.position[c], b.place.position[c]) - 1e-12);
        EXPECT_LE(at.position[c], std::max(a.place.position[c], b.place.position[c]) + 1e-12);
      }
    }
}

TEST(TourPath, ItsSpeedNeverJumps) {
  constexpr double kStep = 1e-4;
  for (const bool eased : {false, true}) {
    const Path path(keys(), eased);
    const auto speed = [&](double t) {
      return (path.at(t + kStep).position - path.at(t).position) * (1 / kStep);
    };
    for (double t = kStep; t < 4 - 3 * kStep; t += kStep)
      EXPECT_LT(cv::norm(speed(t + kStep) - speed(t)), 0.01) << t;
    if (eased) {
      EXPECT_LT(cv::norm(speed(0)), 0.01);
      EXPECT_LT(cv::norm(speed(4 - kStep)), 0.01);
    } else {
      EXPECT_GT(cv::norm(speed(0)), 0.1);
    }
  }
}

TEST(TourPath, TwoKeysWithoutEaseAreALine) {
  const Path path({{0, {}}, {2, {.position = {0, 0, 3}}}}, false);
  for (double t = 0; t <= 2; t += 0.1) EXPECT_NEAR(path.at(t).position[2], 1.5 * t, 1e-12);
}

TEST(TourPath, AnOrbitComesRoundWithoutRest) {
  const Path path = made_path(Move::kOrbit, 1, 4, {.ahead = 3, .aside = 2, .pivot = 6}, true);
  EXPECT_LT(cv::norm(path.at(0).position - path.at(4).position), 1e-12);
  constexpr double kStep = 1e-3;
  const cv::Vec3d leaving = path.at(kStep).position - path.at(0).position,
                  coming = path.at(4).position - path.at(4 - kStep).position;
  EXPECT_LT(cv::norm(leaving - coming), 0.05 * cv::norm(leaving));
  // It looks at its pivot.
  for (double t = 0; t < 4; t += 0.3) {
    const CameraPlace at = path.at(t);
    EXPECT_NEAR(std::tan(at.yaw_deg * CV_PI / 180), -at.position[0] / 6, 2e-3);
  }
}

}  // namespace
}  // namespace freshet::synth::tour
