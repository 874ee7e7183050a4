// synth/field/grid.cc
#include "synth/field/grid.h"

#include <algorithm>

namespace freshet::synth {
namespace {

struct CubicWeights {
  float a, b, c, d;
};
CubicWeights catmull_rom(float t) {
  const float t2 = t * t, t3 = t2 * t;
  return {-0.5f * t3 + t2 - 0.5f * t, 1.5f * t3 - 2.5f * t2 + 1.0f, -1.5f * t3 + 2.0f * t2 + 0.5f * t,
          0.5f * t3 - 0.5f * t2};
}

}  // namespace

float bicubic_limited(const Grid& grid, float x, float y) {
  const Tap tx = tap(x, grid.width), ty = tap(y, grid.height);
  if (tx.index < 1 || ty.index < 1 || tx.index + 2 >= grid.width || ty.index + 2 >= grid.height) {
    return bilinear(grid, x, y);
  }
  const CubicWeights wx = catmull_rom(tx.weight), wy = catmull_rom(ty.weight);
  const float* p = grid.row(ty.index - 1) + tx.index - 1;
  const std::ptrdiff_t stride = grid.width;
  const auto across = [&](const float* q) { return wx.a * q[0] + wx.b * q[1] + wx.c * q[2] + wx.d * q[3]; };
  const float value = wy.a * across(p) + wy.b * across(p + stride) + wy.c * across(p + 2 * stride) +
                      wy.d * across(p + 3 * stride);
  const float a = p[stride + 1], b = p[stride + 2], c = p[2 * stride + 1], d = p[2 * stride + 2];
  const float low = std::min(std::min(a, b), std::min(c, d)), high = std::max(std::max(a, b), std::max(c, d));
  return std::min(std::max(value, low), high);
}

}  // namespace freshet::synth
