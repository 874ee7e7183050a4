// synth/simulate/solver/noise.h — smooth random fields, read at any point.
#pragma once

#include <cstdint>
#include <vector>

#include "synth/field/grid.h"

namespace freshet::synth::simulate {

/// Gradient noise (Perlin 2002), one octave, drawn once and read back: a direct evaluation costs three times
/// as much. Zero mean, about -1..1, one feature per unit; repeats every 32 units, which sums of octaves with
/// unrelated scales and turns hide. 1 MB.
class Noise {
 public:
  explicit Noise(std::uint64_t seed);

  /// |x|, |y| < 2^20. Linear between samples 1/16 apart.
  float operator()(float x, float y) const {
    x = x * kSamplesPerUnit, y = y * kSamplesPerUnit;
    const int ix = floor_to_int(x), iy = floor_to_int(y);
    const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
    const int x0 = ix & kMask, x1 = (ix + 1) & kMask;
    const float* a = values_.data() + static_cast<std::ptrdiff_t>(iy & kMask) * kSide;
    const float* b = values_.data() + static_cast<std::ptrdiff_t>((iy + 1) & kMask) * kSide;
    const float top = a[x0] + (a[x1] - a[x0]) * fx, bottom = b[x0] + (b[x1] - b[x0]) * fx;
    return top + (bottom - top) * fy;
  }

  /// Sum of `octaves`, each `lacunarity` finer, turned, shifted and `gain` as strong as the last: in -1..1.
  float fractal(float x, float y, int octaves, float gain = 0.5f, float lacunarity = 2.03f) const;

  /// A field that also changes with time: two unrelated cuts faded into each other, one unit of time apiece,
  /// with the variance kept.
  float changing(float x, float y, float time, int octaves, float gain = 0.5f) const;

 private:
  static constexpr int kUnits = 32, kSide = 512, kMask = kSide - 1;
  static constexpr float kSamplesPerUnit = 16.0f;
  static int floor_to_int(float x) {
    const int i = static_cast<int>(x);
    return i - static_cast<int>(x < static_cast<float>(i));
  }
  std::vector<float> values_;
};

}  // namespace freshet::synth::simulate
