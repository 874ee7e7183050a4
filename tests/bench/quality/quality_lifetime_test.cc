#include "bench/quality/quality_lifetime.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::bench {
namespace {

const cv::Size kSize(128, 96);

cv::Mat grain(cv::Size size, std::uint64_t seed) {
  cv::Mat values(size, CV_32F);
  cv::RNG random(seed * 0x9E3779B97F4A7C15u);  // its streams of small seeds are alike
  random.fill(values, cv::RNG::NORMAL, 0, 1);
  cv::GaussianBlur(values, values, {}, 1.5);
  return values / (cv::norm(values) / std::sqrt(static_cast<double>(values.total())));
}

cv::Mat shown(const cv::Mat& values) {
  cv::Mat luma;
  values.convertTo(luma, CV_8U, 25, 128);
  return luma;
}

std::vector<cv::Mat> constant_flow(cv::Vec2f px_per_frame, int frames, cv::Size size = kSize) {
  return std::vector<cv::Mat>(frames - 1,
                              cv::Mat(size, CV_32FC2, cv::Scalar(px_per_frame[0], px_per_frame[1])));
}

cv::Mat everywhere(cv::Size size = kSize) { return cv::Mat(size, CV_8U, cv::Scalar(255)); }

std::vector<cv::Mat> sliding(int dx, int dy, int frames) {
  const cv::Mat wide = grain({600, 600}, 3);
  std::vector<cv::Mat> film;
  for (int t = 0; t < frames; ++t)
    film.push_back(shown(wide(cv::Rect(300 - dx * t, 300 - dy * t, kSize.width, kSize.height))));
  return film;
}

/// Grain of which `kept` stays from one frame to the next, and the rest is new: correlation kept^lag.
std::vector<cv::Mat> renewing(double kept, int frames) {
  cv::Mat values = grain(kSize, 1);
  std::vector<cv::Mat> film{shown(values)};
  for (int t = 1; t < frames; ++t) {
    values = kept * values + std::sqrt(1 - kept * kept) * grain(kSize, 100 + t);
    film.push_back(shown(values));
  }
  return film;
}

TEST(QualityLifetime, WhatSlidesAlongItsFlowKeepsItsDetail) {
  const LifetimeCurve curve = lifetime_curve(sliding(1, 2, 40), constant_flow({1, 2}, 40), everywhere());
  for (const double value : curve) EXPECT_GT(value, 0.98);
  EXPECT_NEAR(half_life_s(curve, 24), 1, 1e-9);  // never below a half
  // Followed elsewhere, it is other detail.
  EXPECT_LT(lifetime_curve(sliding(1, 2, 40), constant_flow({-3, 0}, 40), everywhere())[5], 0.3);
}

TEST(QualityLifetime, IsThatOfARenewalOfKnownRate) {
  for (const double kept : {0.8, 0.95}) {
    const LifetimeCurve curve = lifetime_curve(renewing(kept, 75), constant_flow({0, 0}, 75), everywhere());
    for (int lag = 1; lag <= kLifetimeLags; ++lag)
      EXPECT_NEAR(curve[lag - 1], std::pow(kept, lag), 0.06) << kept << " " << lag;
    EXPECT_NEAR(half_life_s(curve, 25), std::ceil(std::log(0.5) / std::log(kept)) / 25, 0.041);
  }
}

// The slow, obvious twin: one pixel after the other, along a flow that differs from place to place.
TEST(QualityLifetime, IsTheSumOverWays) {
  const cv::Size size(48, 40);
  const int frames = 33;
  std::vector<cv::Mat> film, detail, flow;
  for (int t = 0; t < frames; ++t) {
    film.push_back(shown(grain(size, 40 + t / 4)));
    cv::Mat values, blurred;
    film.back().convertTo(values, CV_32F);
    cv::GaussianBlur(values, blurred, {}, 4);
    detail.push_back(values - blurred);
    if (t + 1 == frames) break;
    flow.emplace_back(size, CV_32FC2);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        flow.back().at<cv::Vec2f>(y, x) = {0.3f + 0.01f * static_cast<float>(y),
                                           0.2f * std::sin(0.1f * t + x)};
  }
  cv::Mat matte = everywhere(size);
  matte(cv::Rect(0, 0, 10, 40)) = 0;
  const auto read = [&](const cv::Mat& values, int channels, int channel, double x, double y) {
    const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
    double sum = 0;
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        const double weight = (i ? x - left : 1 - x + left) * (j ? y - top : 1 - y + top);
        if (left + i < 0 || top + j < 0 || left + i >= size.width || top + j >= size.height) continue;
        sum += weight * values.ptr<float>(top + j)[(left + i) * channels + channel];
      }
    return sum;
  };
  std::vector<double> ab(kLifetimeLags), aa(kLifetimeLags), bb(kLifetimeLags);
  for (const int first : {0, 6}) {
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        double px = x, py = y;
        for (int lag = 1; lag <= kLifetimeLags; ++lag) {
          const cv::Mat& step = flow[first + lag - 1];
          const double u = read(step, 2, 0, px, py), v = read(step, 2, 1, px, py);
          px += u, py += v;
          if (matte.at<std::uint8_t>(y, x) == 0 || px <= 1 || py <= 1 || px >= size.width - 2 ||
              py >= size.height - 2 ||
              matte.at<std::uint8_t>(static_cast<int>(std::lround(py)), static_cast<int>(std::lround(px))) ==
                  0)
            continue;
          const double a = detail[first].at<float>(y, x), b = read(detail[first + lag], 1, 0, px, py);
          ab[lag - 1] += a * b, aa[lag - 1] += a * a, bb[lag - 1] += b * b;
        }
      }
  }
  const LifetimeCurve curve = lifetime_curve(film, flow, matte);
  // OpenCV reads between pixels in steps of 1/32.
  for (int lag = 0; lag < kLifetimeLags; ++lag)
    EXPECT_NEAR(curve[lag], ab[lag] / std::sqrt(aa[lag] * bb[lag]), 0.02) << lag;
}

TEST(QualityLifetime, IsThatOfTheMatteAlone) {
  std::vector<cv::Mat> film = sliding(0, 0, 30);
  const std::vector<cv::Mat> other = renewing(0.5, 30);
  const cv::Rect right(64, 0, 64, 96);
  for (int t = 0; t < 30; ++t) other[t](right).copyTo(film[t](right));
  cv::Mat left = everywhere();
  left(cv::Rect(48, 0, 80, 96)) = 0;
  EXPECT_GT(lifetime_curve(film, constant_flow({0, 0}, 30), left)[20], 0.99);
  EXPECT_LT(lifetime_curve(film, constant_flow({0, 0}, 30), everywhere() - left)[20], 0.6);
}

TEST(QualityLifetime, ReducesWideFilmsAndTheirFlow) {
  std::vector<cv::Mat> film;
  const cv::Mat wide = grain({1200, 200}, 8);
  for (int t = 0; t < 30; ++t) film.push_back(shown(wide(cv::Rect(200 - 4 * t, 0, 800, 200))));
  // Flow by cells of 2 px, in px of the film.
  const LifetimeCurve curve =
      lifetime_curve(film, constant_flow({4, 0}, 30, {400, 100}), everywhere({800, 200}));
  EXPECT_GT(curve[20], 0.9);
}

TEST(QualityLifetime, OfTooFewFramesIsNotKnown) {
  const LifetimeCurve curve = lifetime_curve(sliding(0, 0, 25), constant_flow({0, 0}, 25), everywhere());
  EXPECT_TRUE(std::isnan(curve[0]));
  EXPECT_TRUE(std::isnan(half_life_s(curve, 25)));
}

TEST(QualityLifetime, CurvesAreApartByTheirMeanDifference) {
  LifetimeCurve a, b;
  a.fill(0.5);
  b.fill(0.5);
  b[0] = 0.5 + 0.24;
  b[1] = 0.5 - 0.24;
  EXPECT_NEAR(curve_distance(a, b), 0.02, 1e-12);
}

}  // namespace
}  // namespace freshet::bench
