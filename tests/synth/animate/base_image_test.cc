#include "synth/animate/base_image.h"

#include <gtest/gtest.h>

namespace freshet::synth {
namespace {

cv::Mat stripes(cv::Size size, bool vertical) {
  cv::Mat out(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      out.at<float>(y, x) = ((vertical ? x : y) / 4 % 2) != 0 ? 1.0f : 0.0f;
  return out;
}

double contrast(const cv::Mat& picture) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(picture(cv::Rect(40, 40, picture.cols - 80, picture.rows - 80)), mean, deviation);
  return deviation[0];
}

const cv::Size kSize(160, 128);
const cv::Mat kAll(kSize, CV_32F, cv::Scalar(1));

TEST(BaseImage, IsThePictureWhereNothingMoves) {
  const cv::Mat picture = stripes(kSize, true);
  const cv::Mat still = cv::Mat::zeros(kSize, CV_32FC2);
  EXPECT_LT(cv::norm(base_image(picture, kAll, still, {}), picture, cv::NORM_INF), 1e-5);
}

TEST(BaseImage, BlursAlongTheMotionOnly) {
  const cv::Mat motion(kSize, CV_32FC2, cv::Scalar(60, 0));  // px/s, to the right
  const BaseImageOptions sweep_only{.shutter_s = 0.5, .gaussian_s = 0};
  const cv::Mat across = stripes(kSize, true), along = stripes(kSize, false);
  EXPECT_LT(contrast(base_image(across, kAll, motion, sweep_only)), 0.2 * contrast(across));
  EXPECT_GT(contrast(base_image(along, kAll, motion, sweep_only)), 0.99 * contrast(along));
}

TEST(BaseImage, GaussianBlurGrowsWithSpeed) {
  const BaseImageOptions gaussian_only{.shutter_s = 0, .gaussian_s = 0.05};
  const cv::Mat picture = stripes(kSize, false);
  double before = contrast(picture);
  for (double speed : {20.0, 60.0, 120.0}) {
    const cv::Mat motion(kSize, CV_32FC2, cv::Scalar(speed, 0));
    const double now = contrast(base_image(picture, kAll, motion, gaussian_only));
    EXPECT_LT(now, before) << speed << " px/s";
    before = now;
  }
}

TEST(BaseImage, NothingOutsideTheMatteBleedsIn) {
  cv::Mat picture(kSize, CV_32FC3, cv::Scalar::all(0.25)), matte = kAll.clone();
  picture.colRange(0, 80).setTo(cv::Scalar(0, 0, 1));
  matte.colRange(0, 80).setTo(0);
  const cv::Mat motion(kSize, CV_32FC2, cv::Scalar(200, 0));
  const cv::Mat base = base_image(picture, matte, motion, {});
  EXPECT_LT(cv::norm(base.colRange(80, 160), picture.colRange(80, 160), cv::NORM_INF), 1e-3);
}

}  // namespace
}  // namespace freshet::synth
