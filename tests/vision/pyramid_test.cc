#include "vision/pyramid.h"

#include <gtest/gtest.h>

namespace freshet::vision {
namespace {

TEST(Pyramid, CollapsesToThePictureForAnySize) {
  for (const cv::Size size :
       {cv::Size(64, 64), cv::Size(63, 61), cv::Size(97, 40), cv::Size(1, 7), cv::Size(2, 1)}) {
    for (const int type : {CV_8UC1, CV_8UC3, CV_32FC3}) {
      cv::Mat picture(size, type), expected;
      cv::RNG(5).fill(picture, cv::RNG::UNIFORM, 0, 255);
      picture.convertTo(expected, CV_32F);
      std::vector<cv::Mat> bands;
      laplacian_pyramid(picture, 4, bands);
      ASSERT_EQ(bands.size(), 5u);
      EXPECT_LT(cv::norm(collapse(bands), expected, cv::NORM_INF), 2e-4);
    }
  }
}

TEST(Pyramid, BandsOfAConstantPictureAreZero) {
  std::vector<cv::Mat> bands;
  laplacian_pyramid(cv::Mat(50, 70, CV_32F, cv::Scalar(3)), 3, bands);
  for (int i = 0; i < 3; ++i) EXPECT_LT(cv::norm(bands[i], cv::NORM_INF), 1e-5);
  EXPECT_EQ(bands[1].size(), cv::Size(35, 25));
  EXPECT_NEAR(cv::mean(bands[3])[0], 3, 1e-5);
}

TEST(Pyramid, HasAsManyLevelsAsLeaveFourSamples) {
  EXPECT_EQ(levels_within({640, 480}, 5), 5);
  EXPECT_EQ(levels_within({64, 64}, 5), 4);
  EXPECT_EQ(levels_within({640, 9}, 5), 1);
  EXPECT_EQ(levels_within({3, 640}, 5), 0);
}

}  // namespace
}  // namespace freshet::vision
