#include "bench/flowlines/dynamic_texture.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace freshet::bench {
namespace {

constexpr int kWidth = 48, kHeight = 8;

/// Crests 24 px apart that go 1.5 px a frame to the right.
cv::Mat wave(int frame) {
  cv::Mat out(kHeight, kWidth, CV_8UC3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      out.at<cv::Vec3b>(y, x) = cv::Vec3b::all(cv::saturate_cast<std::uint8_t>(
          120 + 80 * std::cos(2 * std::numbers::pi / 24 * (x - 1.5 * frame))));
  return out;
}

TEST(DynamicTexture, GoesOnAsAWaveDoes) {
  std::vector<cv::Mat> clip;
  for (int t = 0; t < 48; ++t) clip.push_back(wave(t));  // three periods
  DynamicTexture texture(clip, {.states = 2, .max_modulus = 1});
  EXPECT_NEAR(texture.found_modulus(), 1, 0.01);
  for (int t = 0; t < 100; ++t)
    EXPECT_LT(cv::norm(texture.next(), wave(t), cv::NORM_INF), 6) << "after " << t << " frames";
  EXPECT_EQ(texture.bytes(), 3 * kWidth * kHeight * (2 + 1) * sizeof(float));
}

/// Deviation, and correlation with a frame before.
struct Course {
  double deviation = 0, memory = 0;
};
Course course_of(const std::vector<double>& levels) {
  double mean = 0, squares = 0, products = 0;
  for (const double level : levels) mean += level / static_cast<double>(levels.size());
  for (std::size_t t = 0; t < levels.size(); ++t) {
    squares += (levels[t] - mean) * (levels[t] - mean);
    if (t > 0) products += (levels[t] - mean) * (levels[t - 1] - mean);
  }
  return {std::sqrt(squares / static_cast<double>(levels.size())), products / squares};
}

/// How bright the left half is: a value that keeps .8 of itself a frame, and gets noise.
TEST(DynamicTexture, HasTheDeviationAndTheMemoryOfItsClip) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise(0, 12);
  std::vector<cv::Mat> clip;
  std::vector<double> clip_levels, levels;
  double value = 0;
  for (int t = 0; t < 300; ++t) {
    clip.emplace_back(kHeight, kWidth, CV_8UC3, cv::Scalar::all(60));
    clip.back().colRange(0, kWidth / 2) = cv::Scalar::all(128 + value);
    clip_levels.push_back(128 + value);
    value = 0.8 * value + noise(random);
  }
  DynamicTexture texture(clip, {.states = 1});
  for (int t = 0; t < 4000; ++t) {
    const cv::Mat& frame = texture.next();
    EXPECT_EQ(frame.at<cv::Vec3b>(3, kWidth - 3)[1], 60);
    levels.push_back(frame.at<cv::Vec3b>(3, 3)[1]);
  }
  const Course of_clip = course_of(clip_levels), of_texture = course_of(levels);
  EXPECT_NEAR(of_texture.deviation, of_clip.deviation, 0.1 * of_clip.deviation);
  EXPECT_NEAR(of_texture.memory, of_clip.memory, 0.03);
}

/// Brighter by a twentieth each frame: least squares finds growth.
TEST(DynamicTexture, DoesNotGrowWithoutAnEnd) {
  std::vector<cv::Mat> clip;
  for (int t = 0; t < 40; ++t) {
    cv::Mat frame(kHeight, kWidth, CV_8UC3, cv::Scalar::all(100));
    const double level = std::pow(1.05, t) * (t % 2 == 0 ? 10 : -10);
    frame.colRange(0, kWidth / 2) = cv::Scalar::all(100 + level);
    clip.push_back(frame);
  }
  DynamicTexture texture(clip, {.states = 1, .max_modulus = 0.95});
  EXPECT_GT(texture.found_modulus(), 1.02);
  cv::Mat last;
  for (int t = 0; t < 300; ++t) last = texture.next();
  EXPECT_NEAR(last.at<cv::Vec3b>(3, 3)[1], 100, 40);
}

}  // namespace
}  // namespace freshet::bench
