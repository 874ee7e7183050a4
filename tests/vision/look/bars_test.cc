#include "vision/look/bars.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "vision/look/horizon.h"

namespace freshet::vision {
namespace {

/// Waves of some light, with grain.
cv::Mat sea(cv::Size size) {
  cv::Mat out(size, CV_8UC3);
  cv::RNG(3).fill(out, cv::RNG::UNIFORM, 40, 90);
  return out;
}

/// Bars of this depth above and below, of a black that a coarse coder made uneven.
cv::Mat letterboxed(cv::Size size, int above, int below) {
  cv::Mat out = sea(size), black(size, CV_8UC3);
  cv::RNG(4).fill(black, cv::RNG::UNIFORM, 14, 18);
  for (const cv::Range& rows : {cv::Range(0, above), cv::Range(size.height - below, size.height)})
    if (!rows.empty()) black.rowRange(rows).copyTo(out.rowRange(rows));
  return out;
}

TEST(Bars, ALetterboxedPictureIsWhatLiesBetweenThem) {
  for (const cv::Size size : {cv::Size(640, 360), cv::Size(1920, 1080), cv::Size(320, 180)}) {
    const int bar = size.height / 8;
    const cv::Rect seen = within_bars(letterboxed(size, bar, bar));
    const int mixed = 1 + 2 * size.width / 640;  // given up at each bar, at most
    EXPECT_EQ(seen.x, 0);
    EXPECT_EQ(seen.width, size.width);
    EXPECT_GE(seen.y, bar);
    EXPECT_LE(seen.y, bar + mixed) << size;
    EXPECT_LE(seen.br().y, size.height - bar);
    EXPECT_GE(seen.br().y, size.height - bar - mixed) << size;
  }
}

TEST(Bars, SomeOfTheSmallestPictureIsWithinThem) {
  for (int height = 1; height <= 24; ++height)
    for (int width : {1, 2, 6, 40})
      for (int bar = 0; 2 * bar < height; ++bar) {
        const cv::Size size(width, height);
        const cv::Rect seen = within_bars(letterboxed(size, bar, bar));
        EXPECT_GT(seen.area(), 0) << size << bar;
        EXPECT_EQ(seen & cv::Rect({}, size), seen) << size << bar;
      }
}

TEST(Bars, BarsAtTheLeftAndRightAreFoundToo) {
  cv::Mat turned;
  cv::rotate(letterboxed({360, 640}, 50, 4), turned,
             cv::ROTATE_90_CLOCKWISE);  // what was above is at the right
  const cv::Rect seen = within_bars(turned);
  EXPECT_NEAR(seen.x, 4, 1);
  EXPECT_NEAR(seen.br().x, 640 - 50, 2);
  EXPECT_EQ(seen.height, 360);
}

TEST(Bars, WhereBarAndPictureAreMixedIsBar) {
  cv::Mat picture = letterboxed({640, 360}, 40, 40);
  picture.rowRange(40, 44) *= 0.3;
  EXPECT_EQ(within_bars(picture).y, 44);
}

TEST(Bars, ThereAreNoneInAPictureOrAroundAFlame) {
  EXPECT_EQ(within_bars(sea({640, 360})), cv::Rect(0, 0, 640, 360));
  cv::Mat flame(360, 640, CV_8UC3, cv::Scalar(0, 0, 0));
  cv::ellipse(flame, {320, 250}, {120, 140}, 0, 0, 360, {40, 140, 250}, cv::FILLED);
  EXPECT_EQ(within_bars(flame), cv::Rect(0, 0, 640, 360));
  EXPECT_EQ(within_bars(cv::Mat::zeros(90, 120, CV_8UC3)), cv::Rect(0, 0, 120, 90)) << "a black picture";
  EXPECT_EQ(within_bars(cv::Mat::zeros(1, 1, CV_8UC3)), cv::Rect(0, 0, 1, 1));
}

TEST(Bars, TheMatteWithinThemHasNoHorizon) {
  const cv::Mat picture = letterboxed({640, 360}, 40, 40), matte = matte_within_bars(picture);
  EXPECT_EQ(matte.at<std::uint8_t>(20, 300), 0);
  EXPECT_EQ(matte.at<std::uint8_t>(180, 300), 255);
  EXPECT_TRUE(horizon_of(matte));
  EXPECT_FALSE(horizon_of_water(picture, matte, "water"));
  cv::Mat shore = matte.clone();
  shore.rowRange(0, 150).setTo(0);
  EXPECT_TRUE(horizon_of_water(picture, shore, "water"));
}

TEST(Bars, ABlackSkyOverASeaHasItsHorizon) {
  const cv::Mat night = letterboxed({640, 360}, 120, 0);
  cv::Mat matte(night.size(), CV_8U, cv::Scalar(255));
  matte.rowRange(0, 120).setTo(0);
  ASSERT_EQ(within_bars(night).y, 120);
  EXPECT_TRUE(horizon_of_water(night, matte, "water"));
}

}  // namespace
}  // namespace freshet::vision
