#include "synth/sampling/cubic.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "platform/vectors.h"

namespace freshet::synth::sampling {
namespace {

FRESHET_WIDE void read_wide(const float* plane, std::ptrdiff_t offset, std::ptrdiff_t stride,
                            const std::int32_t* x, const std::int32_t* y, int n, float* out) {
  cubic(plane, offset, stride, x, y, n, out);
}
FRESHET_WIDE void read_pairs(const float* plane, std::ptrdiff_t offset, std::ptrdiff_t stride,
                             const std::int32_t* x, const std::int32_t* y, int n, float* out, float* second) {
  cubic_pairs(plane, offset, stride, x, y, n, out, second);
}

double keys(double t) {
  constexpr double a = -0.75;
  t = std::abs(t);
  if (t < 1) return ((a + 2) * t - (a + 3)) * t * t + 1;
  return t < 2 ? ((a * t - 5 * a) * t + 8 * a) * t - 4 * a : 0;
}

TEST(Cubic, IsKeysKernelAtEveryPlace) {
  constexpr int kWidth = 40, kHeight = 30, kMargin = 3, kPlaces = 200;  // more than are read at once
  cv::Mat pairs(kHeight, kWidth, CV_32FC2), first;
  cv::RNG random(1);
  random.fill(pairs, cv::RNG::UNIFORM, -1, 1);
  cv::extractChannel(pairs, first, 0);
  std::vector<std::int32_t> x(kPlaces), y(kPlaces);
  for (int i = 0; i < kPlaces; ++i) {
    x[i] = random.uniform(-2 * kCubicSteps, (kWidth - 2 * kMargin) * kCubicSteps);
    y[i] = random.uniform(-2 * kCubicSteps, (kHeight - 2 * kMargin) * kCubicSteps);
  }
  const std::ptrdiff_t offset = kMargin * kWidth + kMargin;
  std::vector<float> out(kPlaces), of_pairs(kPlaces), second(kPlaces);
  read_wide(first.ptr<float>(), offset, kWidth, x.data(), y.data(), kPlaces, out.data());
  read_pairs(pairs.ptr<float>(), offset, kWidth, x.data(), y.data(), kPlaces, of_pairs.data(), second.data());
  for (int i = 0; i < kPlaces; ++i) {
    const double px = static_cast<double>(x[i]) / kCubicSteps + kMargin;
    const double py = static_cast<double>(y[i]) / kCubicSteps + kMargin;
    cv::Vec2d expected;
    for (int row = 0; row < kHeight; ++row)
      for (int column = 0; column < kWidth; ++column)
        expected += keys(px - column) * keys(py - row) * cv::Vec2d(pairs.at<cv::Vec2f>(row, column));
    EXPECT_NEAR(out[i], expected[0], 1e-5) << i;
    EXPECT_NEAR(of_pairs[i], expected[0], 1e-5) << i;
    EXPECT_NEAR(second[i], expected[1], 1e-5) << i;
  }
}

}  // namespace
}  // namespace freshet::synth::sampling
