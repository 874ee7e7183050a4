#include "vision/look/standing.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace freshet::vision {
namespace {

const cv::Size kPicture(320, 240);

cv::Mat textured(const cv::Scalar& colour, double contrast, double grain, std::uint64_t seed) {
  cv::Mat noise(kPicture, CV_32F), texture;
  cv::RNG(seed).fill(noise, cv::RNG::NORMAL, 0, 1);
  cv::GaussianBlur(noise, noise, {}, grain);
  cv::Scalar mean, deviation;
  cv::meanStdDev(noise, mean, deviation);
  noise *= contrast / deviation[0];
  cv::merge(std::vector{noise, noise, noise}, texture);
  texture += colour;
  texture.convertTo(texture, CV_8U);
  return texture;
}

/// Water between two banks, of 100 to 220 px across.
struct Stream {
  cv::Mat picture = textured({60, 90, 80}, 25, .8, 1);
  cv::Mat fluid{kPicture, CV_8U, cv::Scalar(0)};

  Stream() {
    fluid.colRange(100, 220).setTo(255);
    textured({170, 140, 110}, 12, 2, 2).copyTo(picture, fluid);
  }
};

double share(const cv::Mat& held, const cv::Mat& where) {
  return static_cast<double>(cv::countNonZero((held > 127) & where)) / cv::countNonZero(where);
}

TEST(Standing, OfAMatteThatReachesOverTheBankTheRimIsFoundAndTheWaterLeft) {
  const Stream stream;
  cv::Mat matte = stream.fluid.clone();
  matte.colRange(220, 225).setTo(255);
  for (const double scale : {1., 3.}) {
    cv::Mat picture, large;
    cv::resize(stream.picture, picture, {}, scale, scale, cv::INTER_LINEAR);
    cv::resize(matte, large, picture.size(), 0, 0, cv::INTER_NEAREST);
    const cv::Mat held = what_stands(picture, large);
    ASSERT_EQ(held.size(), picture.size());
    cv::Mat fluid;
    cv::resize(stream.fluid, fluid, picture.size(), 0, 0, cv::INTER_NEAREST);
    EXPECT_GT(share(held, large & ~fluid), .7) << scale;
    EXPECT_LT(share(held, fluid), .05) << scale;
    EXPECT_EQ(cv::countNonZero(held & ~large), 0) << scale;
  }
}

TEST(Standing, NoMoreThanATenthOfTheMatteIsTaken) {
  const Stream stream;
  cv::Mat matte = stream.fluid.clone();
  matte.colRange(220, 280).setTo(255);
  const cv::Mat held = what_stands(stream.picture, matte);
  EXPECT_GT(share(held, matte), .02);
  EXPECT_LT(share(held, matte), .11);
}

TEST(Standing, ThePicturesOwnFrameStandsOnTheSidesThatHaveOne) {
  Stream stream;
  const cv::Mat all(kPicture, CV_8U, cv::Scalar(255));
  EXPECT_EQ(cv::countNonZero(own_frame(stream.picture)), 0);
  cv::Mat framed = textured({170, 140, 110}, 12, 2, 3), frame = cv::Mat::zeros(kPicture, CV_8U);
  frame.rowRange(237, 240).setTo(255);
  frame.colRange(0, 2).setTo(255);
  framed.setTo(cv::Scalar(20, 20, 25), frame);
  const cv::Mat found = own_frame(framed) > 127, held = what_stands(framed, all);
  EXPECT_EQ(share(found, frame), 1);
  EXPECT_LT(share(found, ~frame), .01);
  EXPECT_EQ(share(held, frame), 1);
  EXPECT_LT(share(held, ~frame), .11);
}

TEST(Standing, OfNoMatteNothingStandsAndOfAThreadOrAPixelNothingBreaks) {
  const Stream stream;
  cv::Mat matte(kPicture, CV_8U, cv::Scalar(0));
  EXPECT_EQ(cv::countNonZero(what_stands(stream.picture, matte)), 0);
  matte.at<uchar>(100, 100) = 255;
  EXPECT_EQ(cv::countNonZero(what_stands(stream.picture, matte) & ~matte), 0);
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 50), cv::Size(50, 1)}) {
    const cv::Mat picture(size, CV_8UC3, cv::Scalar(9, 90, 190)), whole(size, CV_8U, cv::Scalar(255));
    EXPECT_EQ(what_stands(picture, whole).size(), size);
  }
}

}  // namespace
}  // namespace freshet::vision
