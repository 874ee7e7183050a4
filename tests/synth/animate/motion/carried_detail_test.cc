#include "synth/animate/motion/carried_detail.h"

#include <cmath>

#include <gtest/gtest.h>

namespace freshet::synth::animate {
namespace {

const cv::Rect kCanvas(-8, 16, 96, 64);
constexpr int kStep = 4;

cv::Mat steady(float u, float v) { return cv::Mat(40, 40, CV_32FC2, cv::Scalar(u, v)); }

TEST(CarriedDetail, GoesAlongAndFades) {
  CarriedDetail detail(kCanvas, 1, 0.5);
  cv::Mat spot = cv::Mat::zeros(kCanvas.size(), CV_32F);
  spot.at<float>(20, 30) = 1;
  detail.advance(steady(3, 2), kStep, spot);
  const cv::Mat& now = detail.advance(steady(3, 2), kStep, cv::Mat::zeros(kCanvas.size(), CV_32F));
  EXPECT_NEAR(now.at<float>(22, 33), 0.5, 1e-3);
  EXPECT_NEAR(cv::norm(now, cv::NORM_L1), 0.5, 1e-2);
}

TEST(CarriedDetail, OnAReducedPictureItGoesSoMuchLessFar) {
  CarriedDetail detail(kCanvas, 2, 1);
  cv::Mat spot = cv::Mat::zeros(kCanvas.size(), CV_32F);
  spot.at<float>(20, 30) = 1;
  detail.advance(steady(4, 0), kStep, spot);
  EXPECT_NEAR(detail.advance(steady(4, 0), kStep, cv::Mat::zeros(kCanvas.size(), CV_32F)).at<float>(20, 32),
              1, 1e-3);
}

TEST(CarriedDetail, SettlesAtTheVarianceOfItsInnovations) {
  CarriedDetail detail(kCanvas, 1, 0.8);
  cv::RNG random(7);
  cv::Mat fresh(kCanvas.size(), CV_32F), last;
  for (int i = 0; i < 40; ++i) {
    random.fill(fresh, cv::RNG::NORMAL, 0, 1);
    last = detail.advance(steady(0, 0), kStep, fresh);
  }
  cv::Scalar mean, deviation;
  cv::meanStdDev(last, mean, deviation);
  EXPECT_NEAR(deviation[0], 1 / std::sqrt(1 - 0.64), 0.06);
}

}  // namespace
}  // namespace freshet::synth::animate
