#include "query/min_sum.h"

#include <algorithm>
#include <limits>

namespace freshet::query {
namespace {

// Four lanes exist on every machine that we run on. Written out because a minimum is not vectorised by the
// compiler without -ffinite-math-only.
constexpr std::size_t kLanes = 4;
typedef float Lanes __attribute__((vector_size(16)));
typedef float UnalignedLanes __attribute__((vector_size(16), aligned(4), may_alias));

Lanes load(const float* from) { return *reinterpret_cast<const UnalignedLanes*>(from); }
void store(float* to, Lanes lanes) { *reinterpret_cast<UnalignedLanes*>(to) = lanes; }
Lanes minimum(Lanes a, Lanes b) { return a < b ? a : b; }
Lanes all(float value) { return Lanes{value, value, value, value}; }

}  // namespace

void min_over_rows(const float* table, std::size_t rows, std::size_t columns, const float* a, float* out) {
  std::fill(out, out + columns, std::numeric_limits<float>::infinity());
  // Four rows at a time, so that `out` is read and written a quarter as often.
  std::size_t i = 0;
  for (; i + 4 <= rows; i += 4) {
    const float* t0 = table + i * columns;
    const float* t1 = t0 + columns;
    const float* t2 = t1 + columns;
    const float* t3 = t2 + columns;
    const Lanes a0 = all(a[i]), a1 = all(a[i + 1]), a2 = all(a[i + 2]), a3 = all(a[i + 3]);
    std::size_t j = 0;
    for (; j + kLanes <= columns; j += kLanes) {
      const Lanes upper = minimum(load(t0 + j) + a0, load(t1 + j) + a1);
      const Lanes lower = minimum(load(t2 + j) + a2, load(t3 + j) + a3);
      store(out + j, minimum(load(out + j), minimum(upper, lower)));
    }
    for (; j < columns; ++j) {
      out[j] = std::min({out[j], t0[j] + a[i], t1[j] + a[i + 1], t2[j] + a[i + 2], t3[j] + a[i + 3]});
    }
  }
  for (; i < rows; ++i) {
    const float* row = table + i * columns;
    for (std::size_t j = 0; j < columns; ++j) out[j] = std::min(out[j], row[j] + a[i]);
  }
}

void min_over_columns(const float* table, std::size_t rows, std::size_t columns, const float* a, float* out) {
  for (std::size_t i = 0; i < rows; ++i) {
    const float* row = table + i * columns;
    Lanes best0 = all(std::numeric_limits<float>::infinity()), best1 = best0, best2 = best0, best3 = best0;
    std::size_t j = 0;
    for (; j + 4 * kLanes <= columns; j += 4 * kLanes) {
      best0 = minimum(best0, load(row + j) + load(a + j));
      best1 = minimum(best1, load(row + j + kLanes) + load(a + j + kLanes));
      best2 = minimum(best2, load(row + j + 2 * kLanes) + load(a + j + 2 * kLanes));
      best3 = minimum(best3, load(row + j + 3 * kLanes) + load(a + j + 3 * kLanes));
    }
    for (; j + kLanes <= columns; j += kLanes) best0 = minimum(best0, load(row + j) + load(a + j));
    const Lanes best = minimum(minimum(best0, best1), minimum(best2, best3));
    float least = std::min(std::min(best[0], best[1]), std::min(best[2], best[3]));
    for (; j < columns; ++j) least = std::min(least, row[j] + a[j]);
    out[i] = least;
  }
}

}  // namespace freshet::query
