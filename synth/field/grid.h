// synth/field/grid.h — plain rows of numbers, and how to read between them.
#pragma once

#include <cstdint>
#include <vector>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

namespace freshet::synth {

struct Vec2 {
  float x = 0.0f, y = 0.0f;
};

struct Rgb {  // linear light
  float r = 0.0f, g = 0.0f, b = 0.0f;
};
inline Rgb operator*(Rgb c, float s) { return {c.r * s, c.g * s, c.b * s}; }
inline Rgb operator*(Rgb a, Rgb b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
inline Rgb operator+(Rgb a, Rgb b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
inline Rgb mix(Rgb a, Rgb b, float t) { return a * (1.0f - t) + b * t; }

/// Row-major. Value (x, y) sits at the point (x, y) for every sampler below.
template <typename T>
struct GridOf {
  int width = 0, height = 0;
  std::vector<T> values;

  GridOf() = default;
  GridOf(int w, int h, T fill = {})
      : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill) {}
  T* row(int y) { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
  const T* row(int y) const { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
  T& operator()(int x, int y) { return row(y)[x]; }
  const T& operator()(int x, int y) const { return row(y)[x]; }
};
using Grid = GridOf<float>;
using VectorGrid = GridOf<Vec2>;

/// body(y) for every row, on as many threads as there are. Rows are independent, so the result does not
/// depend on their number.
template <typename Body>
void for_rows(int height, const Body& body) {
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<int>(0, height, 8),
                            [&](const oneapi::tbb::blocked_range<int>& rows) {
                              for (int y = rows.begin(); y < rows.end(); ++y) body(y);
                            });
}

/// A coordinate forced into 0..last, and split. Not-a-number lands on 0: no coordinate may leave the grid.
struct Tap {
  int index = 0;        // left neighbour; index + step is the right one
  int step = 0;         // 0 on a grid one sample wide
  float weight = 0.0f;  // of the right one
};
inline Tap tap(float x, int size) {
  const float last = static_cast<float>(size - 1);
  x = x > 0.0f ? (x < last ? x : last) : 0.0f;
  int i = static_cast<int>(x);
  const int top = size > 1 ? size - 2 : 0;
  i = i < top ? i : top;
  return {i, size > 1 ? 1 : 0, x - static_cast<float>(i)};
}

inline float bilinear(const Grid& grid, float x, float y) {
  const Tap tx = tap(x, grid.width), ty = tap(y, grid.height);
  const float* a = grid.row(ty.index) + tx.index;
  const float* b = grid.row(ty.index + ty.step) + tx.index;
  const float top = a[0] + (a[tx.step] - a[0]) * tx.weight;
  const float bottom = b[0] + (b[tx.step] - b[0]) * tx.weight;
  return top + (bottom - top) * ty.weight;
}

inline Vec2 bilinear(const VectorGrid& grid, float x, float y) {
  const Tap tx = tap(x, grid.width), ty = tap(y, grid.height);
  const Vec2* a = grid.row(ty.index) + tx.index;
  const Vec2* b = grid.row(ty.index + ty.step) + tx.index;
  const float w11 = tx.weight * ty.weight, w10 = ty.weight - w11, w01 = tx.weight - w11;
  const float w00 = 1.0f - tx.weight - w10;
  return {a[0].x * w00 + a[tx.step].x * w01 + b[0].x * w10 + b[tx.step].x * w11,
          a[0].y * w00 + a[tx.step].y * w01 + b[0].y * w10 + b[tx.step].y * w11};
}

/// Catmull-Rom, limited to the range of the four nearest values: as sharp as a cubic, makes no new extremes.
float bicubic_limited(const Grid& grid, float x, float y);

}  // namespace freshet::synth
