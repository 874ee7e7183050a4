#include "synth/animate/still/base_image.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {
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

/// The formula, pixel by pixel, on one level of the Gaussian: a motion alike everywhere.
TEST(BaseImage, IsALineIntegralAndAGaussian) {
  cv::Mat picture(kSize, CV_32F);
  cv::RNG random(2);
  random.fill(picture, cv::RNG::UNIFORM, 0, 1);
  for (const double sigma : {0.0, 1.0, 2.56, 6.5536, 10.48576}) {
    const cv::Mat motion(kSize, CV_32FC2, cv::Scalar(48, -36));  // 60 px/s
    const BaseImageOptions options{.shutter_s = 0.3, .gaussian_s = sigma / 60};
    const cv::Mat found = base_image(picture, kAll, motion, options);
    cv::Mat expected(kSize, CV_32F);
    constexpr int kTaps = 13;  // 18 px
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        double sum = 0;
        for (int i = 0; i < kTaps; ++i) {
          const double along = 18.0 * (i / (kTaps - 1.0) - 0.5);
          const double px = std::clamp(x + 0.8 * along, 0.0, kSize.width - 1.0),
                       py = std::clamp(y - 0.6 * along, 0.0, kSize.height - 1.0);
          const int x0 = static_cast<int>(px), y0 = static_cast<int>(py);
          const int x1 = std::min(x0 + 1, kSize.width - 1), y1 = std::min(y0 + 1, kSize.height - 1);
          const double fx = px - x0, fy = py - y0;
          sum += (1 - fy) * ((1 - fx) * picture.at<float>(y0, x0) + fx * picture.at<float>(y0, x1)) +
                 fy * ((1 - fx) * picture.at<float>(y1, x0) + fx * picture.at<float>(y1, x1));
        }
        expected.at<float>(y, x) = static_cast<float>(sum / kTaps);
      }
    if (sigma > 0) cv::GaussianBlur(expected, expected, {}, sigma, sigma, cv::BORDER_REPLICATE);
    // Wide blurs are made at half the size and less; at the very edge half a sample of those is missing.
    const cv::Rect inner(16, 16, kSize.width - 32, kSize.height - 32);
    EXPECT_LT(cv::norm(found(inner), expected(inner), cv::NORM_INF), sigma >= 4 ? 2e-3 : 1e-4) << sigma;
  }
}

}  // namespace
}  // namespace freshet::synth::animate
