#include "synth/sampling/remapped.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "platform/vectors.h"

namespace freshet::synth::sampling {
namespace {

constexpr int kShift = 5, kSteps = 1 << kShift;

/// A coordinate in steps, the nearest, of two halfway ones the even.
[[gnu::always_inline]] inline std::int32_t steps_of(float at) {
  constexpr float kMost = 1 << 20, kWhole = 12582912;  // 1.5 * 2^23: what is added to it has no fraction left
  const float steps = at * kSteps;
  const float low = steps > -kMost ? steps : -kMost, inside = low < kMost ? low : kMost;
  return static_cast<std::int32_t>((inside + kWhole) - kWhole);
}

[[gnu::always_inline]] inline std::int32_t clamped(std::int32_t at, std::int32_t end) {
  const std::int32_t low = at > 0 ? at : 0;
  return low < end ? low : end - 1;
}

FRESHET_WIDE void part(const float* pairs, int n, float* first, float* second) {
#pragma GCC ivdep
  for (int i = 0; i < n; ++i) {
    first[i] = pairs[2 * i];
    second[i] = pairs[2 * i + 1];
  }
}

/// Along one axis of n samples: offsets of the samples before and after each place, `step` between two of them, and
/// their weights.
FRESHET_WIDE void find_taps(const float* at, int n, int samples, int step, std::int32_t* before,
                            std::int32_t* after, float* of_before, float* of_after) {
#pragma GCC ivdep
  for (int i = 0; i < n; ++i) {
    const std::int32_t steps = steps_of(at[i]), first = steps >> kShift;
    const float fraction = static_cast<float>(steps & (kSteps - 1)) * (1.0f / kSteps);
    const std::int32_t a = clamped(first, samples), b = clamped(first + 1, samples);
    before[i] = a * step;
    after[i] = b * step;
    of_before[i] = 1 - fraction;
    of_after[i] = fraction;
  }
}

/// Of a row of places.
struct Taps {
  std::vector<float> x, y;
  std::array<std::vector<std::int32_t>, 4> offsets;  // left, right, above, below
  std::array<std::vector<float>, 4> weights;

  void resize(std::size_t n) {
    for (auto* each : {&x, &y}) each->resize(n);
    for (auto& each : offsets) each.resize(n);
    for (auto& each : weights) each.resize(n);
  }
};

// l, r, t, b: offsets to the left and so on; wl and so on their weights.
FRESHET_WIDE void read_ones(const float* plane, const std::int32_t* l, const std::int32_t* r,
                            const std::int32_t* t, const std::int32_t* b, const float* wl, const float* wr,
                            const float* wt, const float* wb, int n, float* out) {
#pragma GCC ivdep
  for (int i = 0; i < n; ++i)
    out[i] = plane[t[i] + l[i]] * (wt[i] * wl[i]) + plane[t[i] + r[i]] * (wt[i] * wr[i]) +
             plane[b[i] + l[i]] * (wb[i] * wl[i]) + plane[b[i] + r[i]] * (wb[i] * wr[i]);
}

FRESHET_WIDE void read_pairs(const float* plane, const std::int32_t* l, const std::int32_t* r,
                             const std::int32_t* t, const std::int32_t* b, const float* wl, const float* wr,
                             const float* wt, const float* wb, int n, float* out) {
  typedef float Pair __attribute__((vector_size(8), aligned(4), may_alias));
  const auto at = [plane](std::int32_t offset) { return *reinterpret_cast<const Pair*>(plane + offset); };
  for (int i = 0; i < n; ++i)
    *reinterpret_cast<Pair*>(out + 2 * i) =
        at(t[i] + l[i]) * (wt[i] * wl[i]) + at(t[i] + r[i]) * (wt[i] * wr[i]) +
        at(b[i] + l[i]) * (wb[i] * wl[i]) + at(b[i] + r[i]) * (wb[i] * wr[i]);
}

FRESHET_WIDE void read_fours(const float* plane, const std::int32_t* l, const std::int32_t* r,
                             const std::int32_t* t, const std::int32_t* b, const float* wl, const float* wr,
                             const float* wt, const float* wb, int n, float* out) {
  typedef float Quad __attribute__((vector_size(16), aligned(4), may_alias));
  const auto at = [plane](std::int32_t offset) { return *reinterpret_cast<const Quad*>(plane + offset); };
  for (int i = 0; i < n; ++i)
    *reinterpret_cast<Quad*>(out + 4 * i) =
        at(t[i] + l[i]) * (wt[i] * wl[i]) + at(t[i] + r[i]) * (wt[i] * wr[i]) +
        at(b[i] + l[i]) * (wb[i] * wl[i]) + at(b[i] + r[i]) * (wb[i] * wr[i]);
}

}  // namespace

void read_remapped(const cv::Mat& plane, const cv::Mat& places, cv::Mat& out) {
  const int channels = plane.channels(), n = places.cols;
  CV_Assert(plane.depth() == CV_32F && places.type() == CV_32FC2 &&
            (channels == 1 || channels == 2 || channels == 4));
  out.create(places.size(), plane.type());
  thread_local Taps taps;
  taps.resize(static_cast<std::size_t>(n));
  auto& [left, right, above, below] = taps.offsets;
  auto& [of_left, of_right, of_above, of_below] = taps.weights;
  const auto read = channels == 1 ? read_ones : channels == 2 ? read_pairs : read_fours;
  for (int y = 0; y < places.rows; ++y) {
    part(places.ptr<float>(y), n, taps.x.data(), taps.y.data());
    find_taps(taps.x.data(), n, plane.cols, channels, left.data(), right.data(), of_left.data(),
              of_right.data());
    find_taps(taps.y.data(), n, plane.rows, static_cast<int>(plane.step1()), above.data(), below.data(),
              of_above.data(), of_below.data());
    read(plane.ptr<float>(), left.data(), right.data(), above.data(), below.data(), of_left.data(),
         of_right.data(), of_above.data(), of_below.data(), n, out.ptr<float>(y));
  }
}

}  // namespace freshet::synth::sampling
