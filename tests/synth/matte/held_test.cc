#include "synth/matte/held.h"

#include <gtest/gtest.h>

#include "tests/synth/matte/made_picture.h"

namespace freshet::synth::matte {
namespace {

TEST(Held, IsTakenOutSoftlyAndToTheBitWhereAllIsHeld) {
  cv::Mat alpha(1, 256, CV_8U), held(1, 256, CV_8U);
  for (int i = 0; i < 256; ++i) {
    alpha.at<std::uint8_t>(i) = 200;
    held.at<std::uint8_t>(i) = static_cast<std::uint8_t>(i);
  }
  const cv::Mat left = less_held(alpha, held, "held.png");
  ASSERT_EQ(left.type(), CV_8U);
  EXPECT_EQ(left.at<std::uint8_t>(0), 200);
  EXPECT_EQ(left.at<std::uint8_t>(255), 0);
  for (int i = 0; i < 256; ++i) EXPECT_NEAR(left.at<std::uint8_t>(i), 200 * (255 - i) / 255.0, 0.51) << i;
}

TEST(Held, AllOfTheFluidCannotBeHeld) {
  cv::Mat alpha(20, 20, CV_8U, cv::Scalar(0)), held(20, 20, CV_8U, cv::Scalar(0));
  alpha(cv::Rect(5, 5, 8, 8)).setTo(255);
  held(cv::Rect(4, 4, 10, 10)).setTo(255);
  EXPECT_NE(fault_of(ErrorKind::kInput, [&] { less_held(alpha, held, "held.png"); }).find("held.png"),
            std::string::npos);
}

}  // namespace
}  // namespace freshet::synth::matte
