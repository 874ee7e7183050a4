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

double keys(double t) {
  constexpr double a = -0.75;
  t = std::abs(t);
  if (t < 1) return ((a + 2) * t - (a + 3)) * t * t + 1;
  return t < 2 ? ((a * t - 5 * a) * t + 8 * a) * t - 4 * a : 0;
}

TEST(Cubic, IsKeysKernelAtEveryPlace) {
  constexpr int kWidth = 40, kHeight = 30, kMargin = 3, kPlaces = 200;  // more than are read at once
  cv::Mat plane(kHeight, kWidth, CV_32F);
  cv::RNG random(1);
  random.fill(plane, cv::RNG::UNIFORM, -1, 1);
  std::vector<std::int32_t> x(kPlaces), y(kPlaces);
  for (int i = 0; i < kPlaces; ++i) {
    x[i] = random.uniform(-2 * kCubicSteps, (kWidth - 2 * kMargin) * kCubicSteps);
    y[i] = random.uniform(-2 * kCubicSteps, (kHeight - 2 * kMargin) * kCubicSteps);
  }
  const std::ptrdiff_t offset = kMargin * kWidth + kMargin;
  std::vector<float> out(kPlaces);
  read_wide(plane.ptr<float>(), offset, kWidth, x.data(), y.data(), kPlaces, out.data());
  for (int i = 0; i < kPlaces; ++i) {
    const double px = static_cast<double>(x[i]) / kCubicSteps + kMargin;
    const double py = static_cast<double>(y[i]) / kCubicSteps + kMargin;
    double expected = 0;
    for (int row = 0; row < kHeight; ++row)
      for (int column = 0; column < kWidth; ++column)
        expected += keys(px - column) * keys(py - row) * plane.at<float>(row, column);
    EXPECT_NEAR(out[i], expected, 1e-5) << i;
  }
}

}  // namespace
}  // namespace freshet::synth::sampling
