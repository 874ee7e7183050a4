// The least pass from marks to each pixel, beside relaxation until nothing changes.

#include "synth/matte/pass_height.h"

#include <algorithm>
#include <cfloat>

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::matte {
namespace {

cv::Mat relaxed(const cv::Mat& relief, const cv::Mat& seeds) {
  cv::Mat heights(relief.size(), CV_32F, cv::Scalar(FLT_MAX));
  heights.setTo(0, seeds);
  for (bool changed = true; changed;) {
    changed = false;
    for (int y = 0; y < relief.rows; ++y)
      for (int x = 0; x < relief.cols; ++x)
        for (const cv::Point from :
             {cv::Point(x - 1, y), cv::Point(x + 1, y), cv::Point(x, y - 1), cv::Point(x, y + 1)}) {
          if (!from.inside(cv::Rect({}, relief.size()))) continue;
          const float over = std::max(heights.at<float>(from), relief.at<float>(y, x));
          if (over < heights.at<float>(y, x)) {
            heights.at<float>(y, x) = over;
            changed = true;
          }
        }
  }
  return heights;
}

TEST(PassHeight, IsWhatRelaxationFinds) {
  cv::RNG random(3);
  for (int round = 0; round < 20; ++round) {
    cv::Mat relief(9, 14, CV_32F), seeds(relief.size(), CV_8U, cv::Scalar(0));
    random.fill(relief, cv::RNG::UNIFORM, 0, 1);
    for (int i = 0; i < round % 4; ++i)
      seeds.at<std::uint8_t>(random.uniform(0, 9), random.uniform(0, 14)) = 255;
    EXPECT_EQ(cv::norm(pass_heights(relief, seeds), relaxed(relief, seeds), cv::NORM_INF), 0) << round;
  }
}

TEST(PassHeight, AWallIsPassedWhereItIsLowest) {
  cv::Mat relief(5, 7, CV_32F, cv::Scalar(0.1)), seeds(relief.size(), CV_8U, cv::Scalar(0));
  relief.col(3).setTo(0.9);
  relief.at<float>(4, 3) = 0.4F;
  seeds.at<std::uint8_t>(0, 0) = 1;
  const cv::Mat heights = pass_heights(relief, seeds);
  EXPECT_EQ(heights.at<float>(0, 0), 0);
  EXPECT_EQ(heights.at<float>(4, 2), 0.1F);
  EXPECT_EQ(heights.at<float>(0, 6), 0.4F);
}

TEST(PassHeight, APictureIsSteepAtItsEdgesAlone) {
  cv::Mat picture(40, 60, CV_8UC3, cv::Scalar(90, 60, 30));
  picture.colRange(30, 60).setTo(cv::Scalar(200, 190, 180));
  const cv::Mat steep = steepness(picture);
  EXPECT_EQ(cv::norm(steep.colRange(0, 20), cv::NORM_INF), 0);
  EXPECT_GT(steep.at<float>(20, 30), 5);
}

}  // namespace
}  // namespace freshet::synth::matte
