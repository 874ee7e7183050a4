#include "synth/transfer/files/composite.h"

#include <algorithm>
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

// What each way of joining says, in doubles.
double joined(Blend blend, double colour, double alpha, double under) {
  if (blend == Blend::kOver) return colour * alpha + under * (1 - alpha);
  if (blend == Blend::kAdd) return std::min(1.0, colour * alpha + under);
  return 1 - (1 - colour * alpha) * (1 - under);
}

TEST(Composite, IsTheNearestCodeOfOverAddAndScreen) {
  const cv::Mat under = noise({31, 17}, CV_8UC3, 1);
  for (const Blend blend : {Blend::kOver, Blend::kAdd, Blend::kScreen})
    for (const int type : {CV_8UC4, CV_16UC4}) {
      const double maximum = type == CV_8UC4 ? 255 : 65535;
      const cv::Mat over = noise({31, 17}, type, 2);
      const cv::Mat both = laid_on(over, under, blend);
      for (int y = 0; y < 17; ++y)
        for (int x = 0; x < 31; ++x)
          for (int c = 0; c < 3; ++c) {
            const auto sample = [&](int channel) {
              return (type == CV_8UC4 ? over.at<cv::Vec4b>(y, x)[channel]
                                      : over.at<cv::Vec4w>(y, x)[channel]) /
                     maximum;
            };
            ASSERT_NEAR(both.at<cv::Vec3b>(y, x)[c],
                        255 * joined(blend, sample(c), sample(3), under.at<cv::Vec3b>(y, x)[c] / 255.0),
                        0.5001);
          }
    }
}

TEST(Composite, LightNeverDarkens) {
  const cv::Mat under = noise({31, 17}, CV_8UC3, 3), over = noise({31, 17}, CV_16UC4, 4);
  for (const Blend blend : {Blend::kAdd, Blend::kScreen}) {
    cv::Mat darker;
    cv::subtract(under, laid_on(over, under, blend), darker);
    EXPECT_EQ(cv::norm(darker, cv::NORM_INF), 0);
  }
}

TEST(Composite, LightEndsSoftlyWhereItsFrameEndsWithinThePicture) {
  const cv::Size under(100, 80);
  for (const int type : {CV_8UC4, CV_16UC4}) {
    const int most = type == CV_8UC4 ? 255 : 65535;
    const cv::Mat over(60, 60, type, cv::Scalar::all(most));
    const auto alpha = [&](const cv::Mat& of, int x, int y) {
      return type == CV_8UC4 ? of.at<cv::Vec4b>(y, x)[3] : of.at<cv::Vec4w>(y, x)[3];
    };
    // It ends within on the right and below alone.
    const cv::Mat soft = ending_softly(over, under, {0, -3});
    EXPECT_EQ(alpha(soft, 0, 0), most);
    EXPECT_EQ(alpha(soft, 56, 56), most);
    EXPECT_LT(alpha(soft, 59, 20), most / 8);
    EXPECT_LT(alpha(soft, 20, 59), most / 8);
    EXPECT_LT(alpha(soft, 58, 20), alpha(soft, 57, 20));
    // Colours stay, and a frame as large as the picture is left alone.
    EXPECT_EQ(cv::mean(soft)[0], most);
    EXPECT_EQ(cv::norm(ending_softly(over, over.size(), {0, 0}), over, cv::NORM_INF), 0);
    EXPECT_EQ(cv::mean(over)[3], most);  // not written to
  }
}

TEST(Composite, WhatLiesOutsideIsCutOff) {
  const cv::Mat under(10, 12, CV_8UC3, cv::Scalar(1, 2, 3));
  const cv::Mat over(6, 6, CV_8UC4, cv::Scalar(70, 80, 90, 255));
  for (const cv::Point at : {cv::Point(-3, -2), cv::Point(9, 7), cv::Point(3, 2), cv::Point(20, 0)}) {
    const cv::Mat both = laid_on(over, under, Blend::kOver, at);
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
