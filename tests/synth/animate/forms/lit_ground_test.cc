#include "synth/animate/forms/lit_ground.h"

#include <gtest/gtest.h>

#include "synth/animate/forms/light_level.h"
#include "tests/synth/animate/forms/burning.h"

namespace freshet::synth::animate {
namespace {

const BurningPicture kFire;
const PartedStill kStill = part(kFire.units(), cv::Mat(kFire.size, CV_32F, cv::Scalar(1)));

TEST(LitGround, IsAsInThePictureBelowTheUsualLight) {
  const LitGround ground(kStill, kStill.level, 20, 0.5);
  EXPECT_LT(cv::norm(ground.brightening(kStill.level, 1) - 1, cv::NORM_INF), 1e-5);
}

PartedStill by_day() {
  PartedStill still = kStill;
  still.ground = cv::Mat(cv::max(still.ground, light_of(0.4f)));  // of its own
  return still;
}

TEST(LitGround, FollowsTheLightNearAFireAndStandsFarFromItByDay) {
  const LitGround ground(by_day(), kStill.level, 10, 0.5);
  const cv::Mat darker = ground.brightening(0.5 * kStill.level, 1),
                same = ground.brightening(0.5 * kStill.level, 0);
  EXPECT_LT(darker.at<float>(kFire.bed.y, kFire.bed.x), 0.85);
  EXPECT_GT(darker.at<float>(kFire.bed.y, kFire.bed.x), 0.5);
  EXPECT_NEAR(darker.at<float>(5, 5), 1, 1e-3);
  EXPECT_LT(cv::norm(same - 1, cv::NORM_INF), 1e-6);
}

TEST(LitGround, FollowsTheLightEverywhereInTheDark) {
  const LitGround ground(kStill, kStill.level, 10, 0.5);
  const cv::Mat darker = ground.brightening(0.5 * kStill.level, 1);
  EXPECT_LT(darker.at<float>(kFire.bed.y, 5), 0.85);
  EXPECT_LT(ground.brightening(cv::Mat::zeros(kFire.size, CV_32F), 1).at<float>(5, 5), 0.85);
}

}  // namespace
}  // namespace freshet::synth::animate
