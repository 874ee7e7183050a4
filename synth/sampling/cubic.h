// synth/sampling/cubic.h — cubic interpolation of a plane at many places.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace freshet::synth::sampling {

/// Places are whole numbers of 1 / kCubicSteps px, twice as fine as cv::remap's.
inline constexpr int kCubicShift = 6, kCubicSteps = 1 << kCubicShift;

/// Weights of the four samples around a place (the second is at or before it), by its part of a px. Keys'
/// kernel with a = -3/4, as cv::remap has it: sharper than -1/2.
struct alignas(16) CubicWeights {
  std::array<std::array<float, 4>, kCubicSteps> of;
};
constexpr CubicWeights cubic_weights() {
  CubicWeights weights{};
  constexpr double a = -0.75;
  for (int i = 0; i < kCubicSteps; ++i) {
    const double t = static_cast<double>(i) / kCubicSteps, far = 1 + t, back = 1 - t;
    const double w0 = ((a * far - 5 * a) * far + 8 * a) * far - 4 * a;
    const double w1 = ((a + 2) * t - (a + 3)) * t * t + 1, w2 = ((a + 2) * back - (a + 3)) * back * back + 1;
    weights.of[i] = {static_cast<float>(w0), static_cast<float>(w1), static_cast<float>(w2),
                     static_cast<float>(1 - w0 - w1 - w2)};
  }
  return weights;
}
inline constexpr CubicWeights kCubic = cubic_weights();

/// out[i] = the plane at the place (x[i], y[i]), in steps. Its 4 x 4 samples must exist; they lie at
/// plane[offset + (row - 1 .. row + 2) * stride + column - 1 .. column + 2].
/// Inlined, so that it is compiled for the widths of a FRESHET_WIDE caller. One row of four samples is one
/// vector: gathering 16 samples a place into wider ones is slower.
[[gnu::always_inline]] inline void cubic(const float* plane, std::ptrdiff_t offset, std::ptrdiff_t stride,
                                         const std::int32_t* x, const std::int32_t* y, int n, float* out) {
  typedef float Quad __attribute__((vector_size(16)));
  typedef float UnalignedQuad __attribute__((vector_size(16), aligned(4), may_alias));
  constexpr int kRun = 64;
  alignas(64) float products[4 * kRun];
  for (int first = 0; first < n; first += kRun) {
    const int count = n - first < kRun ? n - first : kRun;
    for (int i = 0; i < count; ++i) {
      const std::int32_t px = x[first + i], py = y[first + i];
      const float* from = plane + offset + ((py >> kCubicShift) - 1) * stride + (px >> kCubicShift) - 1;
      const auto& wy = kCubic.of[py & (kCubicSteps - 1)];
      const auto row = [from, stride](int r) -> Quad {
        return *reinterpret_cast<const UnalignedQuad*>(from + r * stride);
      };
      const Quad sum = (row(0) * wy[0] + row(1) * wy[1]) + (row(2) * wy[2] + row(3) * wy[3]);
      *reinterpret_cast<Quad*>(products + 4 * i) =
          sum * *reinterpret_cast<const Quad*>(kCubic.of[px & (kCubicSteps - 1)].data());
    }
    for (int i = 0; i < count; ++i)
      out[first + i] = (products[4 * i] + products[4 * i + 1]) + (products[4 * i + 2] + products[4 * i + 3]);
  }
}

}  // namespace freshet::synth::sampling
