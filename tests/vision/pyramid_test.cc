#include "vision/pyramid.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

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

TEST(Pyramid, OfOneChannelIsWhatOpenCvMakes) {
  for (const cv::Size size : {cv::Size(640, 480), cv::Size(63, 61), cv::Size(97, 40), cv::Size(5, 6)}) {
    cv::Mat picture(size, CV_32F), rest, smaller, blurred;
    cv::RNG(5).fill(picture, cv::RNG::UNIFORM, -1, 1);
    std::vector<cv::Mat> bands;
    laplacian_pyramid(picture, 3, bands);
    rest = picture;
    for (int level = 0; level < 3; ++level) {
      cv::pyrDown(rest, smaller);
      cv::pyrUp(smaller, blurred, rest.size());
      EXPECT_LT(cv::norm(bands[level], rest - blurred, cv::NORM_INF), 1e-6) << size << " " << level;
      rest = smaller.clone();
    }
    EXPECT_LT(cv::norm(bands[3], rest, cv::NORM_INF), 1e-6) << size;
  }
}

TEST(Pyramid, BandsMayBeAmplifiedOnTheWay) {
  cv::Mat picture(50, 70, CV_32F);
  cv::RNG(5).fill(picture, cv::RNG::UNIFORM, 0, 1);
  std::vector<cv::Mat> bands, louder;
  laplacian_pyramid(picture, 2, bands);
  laplacian_pyramid(picture, 2, louder);
  louder[0] *= 1.5;
  const std::vector<float> gains{1.5f};
  EXPECT_LT(cv::norm(collapse(std::move(bands), gains), collapse(louder), cv::NORM_INF), 1e-6);
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
