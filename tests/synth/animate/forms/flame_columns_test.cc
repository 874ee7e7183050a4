#include "synth/animate/forms/flame_columns.h"

#include <vector>

#include <gtest/gtest.h>

namespace freshet::synth::animate {
namespace {

constexpr float kBurns = 0.8f;

cv::Mat dark() { return cv::Mat::zeros(200, 200, CV_32F); }

/// A flame over the columns 60 .. 139, from row 50 to row 149.
cv::Mat one_flame() {
  cv::Mat level = dark();
  level(cv::Rect(60, 50, 80, 100)) = kBurns;
  return level;
}

TEST(FlameColumns, ABedIsTheLowestRowAndSpecksHaveNone) {
  cv::Mat level = one_flame();
  level.at<float>(180, 20) = kBurns;
  const std::vector<float> bed = beds_of(level);
  EXPECT_FLOAT_EQ(bed[100], 149);
  EXPECT_EQ(bed[20], -1);
  EXPECT_EQ(beds_of(dark()), std::vector<float>(200, -1));
}

TEST(FlameColumns, LightReachesAroundTheFlamesButNotBelowTheirBed) {
  const cv::Mat reach = reach_of(one_flame());
  for (int y = 31; y < 150; ++y) EXPECT_EQ(reach.at<float>(y, 100), 1) << y;
  EXPECT_NEAR(reach.at<float>(20, 100), 0.5, 0.1);
  EXPECT_EQ(reach.at<float>(8, 100), 0);
  for (int y = 153; y < 200; ++y) EXPECT_EQ(reach.at<float>(y, 100), 0) << y;
  EXPECT_EQ(reach.at<float>(100, 150), 1);
  EXPECT_EQ(reach.at<float>(100, 185), 0);
}

TEST(FlameColumns, AFlameIsFreeTowardsItsTip) {
  const cv::Mat tips = tips_of(one_flame());
  for (int x : {100, 60, 10}) {
    EXPECT_EQ(tips.at<float>(199, x), 0) << x;
    EXPECT_EQ(tips.at<float>(130, x), 0) << x;
    EXPECT_NEAR(tips.at<float>(99, x), 0.5, 0.02) << x;
    EXPECT_EQ(tips.at<float>(68, x), 1) << x;
    EXPECT_EQ(tips.at<float>(0, x), 1) << x;
  }
  EXPECT_EQ(cv::countNonZero(tips_of(dark())), 0);
}

TEST(FlameColumns, ItIsTheHighestFlameThatIsFree) {
  cv::Mat level = one_flame();
  level(cv::Rect(60, 110, 80, 10)) = 0;  // a log before it, whose lower half burns as well
  const cv::Mat tips = tips_of(level);
  EXPECT_EQ(tips.at<float>(109, 100), 0);
  EXPECT_EQ(tips.at<float>(130, 100), 0);
  EXPECT_EQ(tips.at<float>(60, 100), 1);
  level(cv::Rect(60, 110, 80, 10)) = kBurns;
  level(cv::Rect(60, 110, 80, 2)) = 0;  // a dark line is no log
  EXPECT_NEAR(tips_of(level).at<float>(99, 100), 0.5, 0.02);
}

}  // namespace
}  // namespace freshet::synth::animate
