#include "synth/tour/texture.h"

#include <cmath>

#include <gtest/gtest.h>

namespace freshet::synth::tour {
namespace {

cv::Mat drawn(cv::Size size, const std::function<float(int, int)>& value) {
  cv::Mat out(size, CV_8UC3);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      out.at<cv::Vec3b>(y, x) = cv::Vec3b::all(cv::saturate_cast<std::uint8_t>(255 * value(x, y)));
  return out;
}

std::vector<float> row_of(const Texture& texture, const cv::Matx33d& homography, int x, int y, int n) {
  std::vector<cv::Vec4f> row(static_cast<std::size_t>(n));
  texture.read(homography, x, y, n, row.data());
  std::vector<float> greens;
  for (const cv::Vec4f& each : row) greens.push_back(each[1]);
  return greens;
}

TEST(TourTexture, IsItselfUnmoved) {
  Texture texture({37, 23}, Texture::Beyond::kMirrored);
  const cv::Mat noise = drawn({37, 23}, [](int x, int y) { return std::fmod(0.37f * x + 0.61f * y, 1.0f); });
  texture.set(noise);
  for (int y = 0; y < 23; ++y) {
    const std::vector<float> row = row_of(texture, cv::Matx33d::eye(), 0, y, 37);
    for (int x = 0; x < 37; ++x) EXPECT_NEAR(255 * row[x], noise.at<cv::Vec3b>(y, x)[1], 1e-3);
  }
}

TEST(TourTexture, ShrunkItIsTheMean) {
  Texture texture({256, 256}, Texture::Beyond::kMirrored);
  texture.set(drawn({256, 256}, [](int x, int y) { return static_cast<float>((x + y) % 2); }));
  for (const double scale : {3.0, 5.3, 8.0})
    for (const float value : row_of(texture, cv::Matx33d::diag({scale, scale, 1}), 2, 5, 20))
      EXPECT_NEAR(value, 0.5, 0.06) << scale;
}

// A floor seen flat: rows are many in a pixel, columns are not.
TEST(TourTexture, StripesAlongTheFloorStaySharp) {
  Texture texture({256, 256}, Texture::Beyond::kMirrored);
  texture.set(drawn({256, 256}, [](int x, int) { return x / 4 % 2 == 0 ? 1.0f : 0.0f; }));
  const std::vector<float> row = row_of(texture, cv::Matx33d::diag({1, 6, 1}), 40, 10, 64);
  EXPECT_GT(*std::ranges::max_element(row) - *std::ranges::min_element(row), 0.95f);
  texture.set(drawn({256, 256}, [](int, int y) { return y % 4 < 2 ? 1.0f : 0.0f; }));
  for (const float value : row_of(texture, cv::Matx33d::diag({1, 6, 1}), 40, 10, 64))
    EXPECT_NEAR(value, 0.5, 0.12);
}

// From sharp to averaged nothing jumps: what grows slowly out of the picture does not pop.
TEST(TourTexture, ScalesGoOverIntoEachOther) {
  Texture texture({128, 128}, Texture::Beyond::kMirrored);
  texture.set(
      drawn({128, 128}, [](int x, int y) { return 0.5f + 0.4f * std::sin(0.8f * x) * std::cos(0.9f * y); }));
  const auto at = [&](double scale) {
    const cv::Matx33d around(1, 0, 60, 0, 1, 60, 0, 0, 1);
    return row_of(texture, around * cv::Matx33d::diag({1, scale, 1}), -20, 0, 40);
  };
  for (const double scale : {0.5, 0.999, 1.0, 1.0001, 1.3, 2.0, 2.4}) {
    const std::vector<float> before = at(scale), after = at(scale + 1e-3);
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(before[i], after[i], 0.01) << scale;
  }
}

TEST(TourTexture, BeyondItsEdgesItIsMirroredOrNothing) {
  const cv::Size size(16, 12);
  const cv::Mat ramp = drawn(size, [](int x, int) { return 0.05f * static_cast<float>(x); });
  Texture mirrored(size, Texture::Beyond::kMirrored), alone(size, Texture::Beyond::kNothing);
  mirrored.set(ramp);
  alone.set(ramp);
  const std::vector<float> row = row_of(mirrored, cv::Matx33d::eye(), -40, 3, 96);
  for (int i = 0; i < 96; ++i) {
    const int x = ((i - 40) % 32 + 32) % 32;
    EXPECT_NEAR(255 * row[i], ramp.at<cv::Vec3b>(3, x < 16 ? x : 31 - x)[1], 1e-2) << i - 40;
  }
  const std::vector<float> lone = row_of(alone, cv::Matx33d::eye(), -40, 3, 96);
  EXPECT_EQ(lone[38], 0);
  EXPECT_EQ(lone[57], 0);
}

}  // namespace
}  // namespace freshet::synth::tour
