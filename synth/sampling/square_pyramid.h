// synth/sampling/square_pyramid.h — Laplacian pyramids of small squares.
#pragma once

#include <cstddef>

namespace freshet::synth::sampling {

// The pyramid of a piece, as cv::pyrDown and cv::pyrUp make it (Burt and Adelson 1983): for pictures of 48 px
// and less these spend most of their time on being called. Squares of n x n samples, rows one after another;
// n even, at least kMinSquare. Inlined, so that they are compiled for the widths of a FRESHET_WIDE caller.
inline constexpr int kMinSquare = 4;

/// Rows to half as many.
/// line   scratch: n samples and two on either side.
[[gnu::always_inline]] inline void reduce_square(const float* from, int n, float* line, float* to) {
  // Mirrored at the edge samples.
  const auto row = [from, n](int y) { return from + n * (y < 0 ? -y : y < n ? y : 2 * n - 2 - y); };
  for (int y = 0; y < n / 2; ++y) {
    const float *a = row(2 * y - 2), *b = row(2 * y - 1), *c = row(2 * y), *d = row(2 * y + 1),
                *e = row(2 * y + 2);
    float* l = line + 2;
    for (int x = 0; x < n; ++x) l[x] = (a[x] + e[x]) + 4 * (b[x] + d[x]) + 6 * c[x];
    l[-1] = l[1];
    l[-2] = l[2];
    l[n] = l[n - 2];
    for (int x = 0; x < n / 2; ++x)
      to[y * (n / 2) + x] =
          ((l[2 * x - 2] + l[2 * x + 2]) + 4 * (l[2 * x - 1] + l[2 * x + 1]) + 6 * l[2 * x]) * (1.0f / 256);
  }
}

/// Columns of n / 2 samples per row to n.
/// line   scratch: n / 2 samples and one on either side.
[[gnu::always_inline]] inline void widen_square(const float* from, int n, float* line, float* to) {
  const int half = n / 2;
  for (int y = 0; y < half; ++y) {
    float* l = line + 1;
    for (int x = 0; x < half; ++x) l[x] = from[y * half + x];
    l[-1] = l[1];
    l[half] = l[half - 1];
    for (int x = 0; x < half; ++x) {
      to[y * n + 2 * x] = (l[x - 1] + l[x + 1]) + 6 * l[x];
      to[y * n + 2 * x + 1] = 4 * (l[x] + l[x + 1]);
    }
  }
}

/// sum += (current - what `low` becomes at twice the size) * weight, row by row.
/// wide   low, widened.
[[gnu::always_inline]] inline void add_band(const float* current, const float* wide, const float* weight,
                                            int n, float* sum, std::ptrdiff_t stride) {
  constexpr float kUnit = 1.0f / 64;
  const int half = n / 2;
  for (int y = 0; y < half; ++y) {
    const float *a = wide + n * (y > 0 ? y - 1 : 1), *b = wide + n * y,
                *c = wide + n * (y + 1 < half ? y + 1 : half - 1);
    const float *upper = current + 2 * n * y, *lower = upper + n;
    const float *upper_weight = weight + 2 * n * y, *lower_weight = upper_weight + n;
    float *upper_sum = sum + 2 * y * stride, *lower_sum = upper_sum + stride;
#pragma GCC ivdep  // nine rows that share nothing: too many for the compiler to ask
    for (int x = 0; x < n; ++x) {
      upper_sum[x] += (upper[x] - ((a[x] + c[x]) + 6 * b[x]) * kUnit) * upper_weight[x];
      lower_sum[x] += (lower[x] - 4 * (b[x] + c[x]) * kUnit) * lower_weight[x];
    }
  }
}

}  // namespace freshet::synth::sampling
