#include "synth/animate/still/colour_model.h"

#include <gtest/gtest.h>

#include "tests/harness/noise.h"

namespace freshet::synth::animate {
namespace {

TEST(ColourModel, KeepsLuminanceExactly) {
  cv::Mat bgr(96, 128, CV_32FC3), coloured;
  cv::RNG rng(3);
  rng.fill(bgr, cv::RNG::UNIFORM, 0.0, 1.0);
  const cv::Mat matte(bgr.size(), CV_32F, cv::Scalar(1));
  const ColourModel model = fit_colour(bgr, luma_of(bgr), matte);
  const cv::Mat other = noise(bgr.size(), CV_32F, 8, 0.1, 0.9);
  apply_colour(model, other, coloured);
  EXPECT_LT(cv::norm(luma_of(coloured), other, cv::NORM_INF), 1e-4);
}

TEST(ColourModel, FindsTheColourThatGoesWithLuminance) {
  // Dark red to bright yellow, as flames are.
  const cv::Mat key = noise({128, 96}, CV_32F, 4, 0.1, 0.9);
  cv::Mat bgr(key.size(), CV_32FC3), coloured;
  for (int y = 0; y < key.rows; ++y)
    for (int x = 0; x < key.cols; ++x) {
      const float v = key.at<float>(y, x);
      bgr.at<cv::Vec3f>(y, x) = {0.1f * v, 0.2f + 0.6f * v, 0.5f + 0.4f * v};
    }
  const cv::Mat matte(bgr.size(), CV_32F, cv::Scalar(1));
  const cv::Mat luma = luma_of(bgr);
  const ColourModel model = fit_colour(bgr, luma, matte, 12, 1e-6);
  cv::Mat mirrored_luma, mirrored_bgr;
  cv::flip(luma, mirrored_luma, 1);
  cv::flip(bgr, mirrored_bgr, 1);
  apply_colour(model, mirrored_luma, coloured);
  EXPECT_LT(cv::norm(coloured, mirrored_bgr, cv::NORM_INF), 0.01);
}

}  // namespace
}  // namespace freshet::synth::animate
