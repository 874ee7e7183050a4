#include "synth/animate/forms/form_look.h"

#include <gtest/gtest.h>

#include "synth/animate/forms/light_level.h"
#include "synth/animate/forms/parted_still.h"
#include "tests/synth/animate/forms/burning.h"

namespace freshet::synth::animate {
namespace {

TEST(LevelMaps, AreMonotoneAndLeaveTheDarkDark) {
  const cv::Mat still = 0.9 * flame({100, 100}, {50, 90}, 60, 70);
  std::vector<cv::Mat> forms;
  for (const int lean : {-8, 0, 8}) forms.push_back(0.4 * flame({100, 100}, {50, 90}, 50, 80, lean));
  const LevelMaps maps(still, forms, 20, 90);
  cv::Mat ramp(100, 256, CV_32F);
  for (int x = 0; x < 256; ++x) ramp.col(x).setTo(x / 255.0);
  maps.apply(ramp);
  EXPECT_EQ(cv::norm(ramp.col(0), cv::NORM_INF), 0);
  for (int y = 0; y < 100; ++y)
    for (int x = 1; x < 256; ++x) EXPECT_GE(ramp.at<float>(y, x), ramp.at<float>(y, x - 1)) << x << ", " << y;
}

TEST(LevelMaps, MakeDimFlamesAsBrightAsThePictures) {
  const cv::Mat still = 0.9 * flame({100, 100}, {50, 90}, 60, 70);
  const std::vector<cv::Mat> forms{0.4 * flame({100, 100}, {50, 90}, 60, 70)};
  cv::Mat level = forms[0].clone();
  LevelMaps(still, forms, 20, 90).apply(level);
  EXPECT_NEAR(level.at<float>(80, 50), 0.9, 0.08);
}

TEST(Softness, IsWhatACrisperFormLacks) {
  const cv::Mat crisp = flame({100, 100}, {50, 90}, 12, 70);
  cv::Mat soft;
  cv::GaussianBlur(crisp, soft, {}, 2);
  EXPECT_GT(softness(soft, std::vector{crisp}), 1);
  EXPECT_EQ(softness(crisp, std::vector{crisp}), 0);
  EXPECT_EQ(softness(crisp, std::vector{soft}), 0);
}

TEST(LightColours, AreThePicturesOwn) {
  const PartedStill parted = part(BurningPicture{}.units(), cv::Mat(160, 200, CV_32F, cv::Scalar(1)));
  const LightColours colours(parted.light, parted.level);
  EXPECT_EQ(cv::norm(colours.at(0)), 0);
  // Orange, then yellow: red before green before blue all the way, and brighter with the level.
  for (int i = 10; i <= 100; ++i) {
    const cv::Vec3f colour = colours.at(static_cast<float>(i) / 100);
    EXPECT_GE(colour[2], colour[1]) << i;
    EXPECT_GE(colour[1], colour[0]) << i;
    const float luma = 0.114f * colour[0] + 0.587f * colour[1] + 0.299f * colour[2];
    EXPECT_NEAR(level_of(luma), i / 100.0, 0.01);
  }
  const cv::Vec3f bright = colours.at(0.85f), dim = colours.at(0.5f);
  EXPECT_GT(bright[1] / bright[2], dim[1] / dim[2]);
}

}  // namespace
}  // namespace freshet::synth::animate
