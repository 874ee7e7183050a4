#include "vision/flow_outliers.h"

#include <vector>

#include <gtest/gtest.h>

namespace freshet::vision {
namespace {

using enum FlowOutlier;

TEST(FlowOutliers, ACutIsFastAndARepeatedFrameIsStill) {
  EXPECT_EQ(flow_outliers(std::vector<float>{2, 2.2f, 1.9f, 9, 2, 0, 2, 2.1f, 1.8f}),
            (std::vector{kNone, kNone, kNone, kFast, kNone, kStill, kNone, kNone, kNone}));
}

TEST(FlowOutliers, EveryFrameTwiceIsNotFastBetween) {
  EXPECT_EQ(flow_outliers(std::vector<float>{0, 4, 0, 4, 0, 4, 0}),
            (std::vector{kStill, kNone, kStill, kNone, kStill, kNone, kStill}));
}

TEST(FlowOutliers, AClipThatHardlyMovesOrStandsHasNone) {
  EXPECT_EQ(flow_outliers(std::vector<float>{0.02f, 0.02f, 0.1f, 0.02f}), std::vector(4, kNone));
  EXPECT_EQ(flow_outliers(std::vector<float>(5, 0)), std::vector(5, kNone));
  EXPECT_TRUE(flow_outliers({}).empty());
}

}  // namespace
}  // namespace freshet::vision
