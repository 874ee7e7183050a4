#include "ingest/frame_timing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace freshet::ingest {
namespace {

TEST(FrameTiming, StampsThatAContainerRoundedAreSteady) {
  std::vector<double> matroska, phone;
  for (int i = 0; i < 90; ++i) {
    matroska.push_back(std::round(i * 1000 / 59.94) / 1000);
    phone.push_back(std::round(i * 600 / 29.97) / 600);
  }
  EXPECT_TRUE(timing_of(matroska).steady);
  EXPECT_NEAR(timing_of(matroska).fps, 59.94, 0.02);
  EXPECT_TRUE(timing_of(phone).steady);
  EXPECT_EQ(pair_rate(0.033, 30), 30);
}

TEST(FrameTiming, ADroppedFrameIsSeenAndHasItsOwnRate) {
  std::vector<double> times;
  for (int i = 0; i < 60; ++i)
    if (i != 20) times.push_back(i / 30.0);
  const FrameTiming timing = timing_of(times);
  EXPECT_FALSE(timing.steady);
  EXPECT_NEAR(timing.slowest_fps, 15, 1e-9);
  EXPECT_NEAR(timing.fastest_fps, 30, 1e-9);
  EXPECT_NEAR(timing.gap_after_s, 19 / 30.0, 1e-9);
  EXPECT_NEAR(pair_rate(times[20] - times[19], timing.fps), 15, 1e-9);
  EXPECT_EQ(pair_rate(times[2] - times[1], timing.fps), timing.fps);
}

TEST(FrameTiming, NothingIsSaidOfLessThanTwoFrames) {
  EXPECT_EQ(timing_of({}).fps, 0);
  const std::vector<double> one{0};
  EXPECT_TRUE(timing_of(one).steady);
}

}  // namespace
}  // namespace freshet::ingest
