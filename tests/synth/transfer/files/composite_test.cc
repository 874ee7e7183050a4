#include "synth/transfer/files/composite.h"

#include <cstdint>

#include <gtest/gtest.h>

namespace freshet::synth::transfer {
namespace {

cv::Mat noise(cv::Size size, int type, std::uint64_t seed) {
  cv::Mat picture(size, type);
  cv::RNG random(seed);
  random.fill(picture, cv::RNG::UNIFORM, 0, picture.depth() == CV_8U ? 256 : 65536);
  return picture;
}

TEST(Composite, IsTheNearestCodeOfOver) {
  const cv::Mat under = noise({31, 17}, CV_8UC3, 1);
  for (const int type : {CV_8UC4, CV_16UC4}) {
    const double maximum = type == CV_8UC4 ? 255 : 65535;
    const cv::Mat over = noise({31, 17}, type, 2);
    const cv::Mat both = lay_over(over, under);
    for (int y = 0; y < 17; ++y)
      for (int x = 0; x < 31; ++x)
        for (int c = 0; c < 3; ++c) {
          const auto sample = [&](int channel) {
            return (type == CV_8UC4 ? over.at<cv::Vec4b>(y, x)[channel] : over.at<cv::Vec4w>(y, x)[channel]) /
                   maximum;
          };
          const double expected =
              255 * sample(c) * sample(3) + under.at<cv::Vec3b>(y, x)[c] * (1 - sample(3));
          ASSERT_NEAR(both.at<cv::Vec3b>(y, x)[c], expected, 0.5001);
        }
  }
}

TEST(Composite, WhatLiesOutsideIsCutOff) {
  const cv::Mat under(10, 12, CV_8UC3, cv::Scalar(1, 2, 3));
  const cv::Mat over(6, 6, CV_8UC4, cv::Scalar(70, 80, 90, 255));
  for (const cv::Point at : {cv::Point(-3, -2), cv::Point(9, 7), cv::Point(3, 2), cv::Point(20, 0)}) {
    const cv::Mat both = lay_over(over, under, at);
    ASSERT_EQ(both.size(), under.size());
    for (int y = 0; y < 10; ++y)
      for (int x = 0; x < 12; ++x)
        EXPECT_EQ(both.at<cv::Vec3b>(y, x),
                  cv::Rect(at, over.size()).contains({x, y}) ? cv::Vec3b(70, 80, 90) : cv::Vec3b(1, 2, 3));
  }
  EXPECT_EQ(under.at<cv::Vec3b>(5, 5), cv::Vec3b(1, 2, 3));  // not written to
}

}  // namespace
}  // namespace freshet::synth::transfer
