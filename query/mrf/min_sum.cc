#include "query/mrf/min_sum.h"

#include <algorithm>
#include <bit>
#include <cstdint>
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

// Eight costs of a table. Each becomes the upper half of a word.
typedef std::uint16_t Halves __attribute__((vector_size(16)));
typedef std::uint16_t UnalignedHalves __attribute__((vector_size(16), aligned(2), may_alias));
typedef std::uint32_t Words __attribute__((vector_size(16)));
constexpr std::size_t kCosts = 2 * kLanes;

struct Costs {
  Lanes first, second;
};

Lanes to_floats(Halves upper) {
  static_assert(std::endian::native == std::endian::little);
  return std::bit_cast<Lanes>(std::bit_cast<Words>(upper) >> (16 - PairCost::kShift)) * all(PairCost::kOut);
}

Costs load(const PairCost* from) {
  const Halves costs = *reinterpret_cast<const UnalignedHalves*>(from), zeros{};
  return {to_floats(__builtin_shufflevector(zeros, costs, 0, 8, 1, 9, 2, 10, 3, 11)),
          to_floats(__builtin_shufflevector(zeros, costs, 4, 12, 5, 13, 6, 14, 7, 15))};
}

}  // namespace

void min_over_rows(const PairCost* table, std::size_t rows, std::size_t columns, const float* a, float* out) {
  std::fill(out, out + columns, std::numeric_limits<float>::infinity());
  // Four rows at a time, so that `out` is read and written a quarter as often.
  std::size_t i = 0;
  for (; i + 4 <= rows; i += 4) {
    const PairCost* t0 = table + i * columns;
    const PairCost* t1 = t0 + columns;
    const PairCost* t2 = t1 + columns;
    const PairCost* t3 = t2 + columns;
    const Lanes a0 = all(a[i]), a1 = all(a[i + 1]), a2 = all(a[i + 2]), a3 = all(a[i + 3]);
    std::size_t j = 0;
    for (; j + kCosts <= columns; j += kCosts) {
      const Costs c0 = load(t0 + j), c1 = load(t1 + j), c2 = load(t2 + j), c3 = load(t3 + j);
      const Lanes first =
          minimum(minimum(c0.first + a0, c1.first + a1), minimum(c2.first + a2, c3.first + a3));
      const Lanes second =
          minimum(minimum(c0.second + a0, c1.second + a1), minimum(c2.second + a2, c3.second + a3));
      store(out + j, minimum(load(out + j), first));
      store(out + j + kLanes, minimum(load(out + j + kLanes), second));
    }
    for (; j < columns; ++j) {
      out[j] = std::min({out[j], t0[j] + a[i], t1[j] + a[i + 1], t2[j] + a[i + 2], t3[j] + a[i + 3]});
    }
  }
  for (; i < rows; ++i) {
    const PairCost* row = table + i * columns;
    for (std::size_t j = 0; j < columns; ++j) out[j] = std::min(out[j], row[j] + a[i]);
  }
}

void min_over_columns(const PairCost* table, std::size_t rows, std::size_t columns, const float* a,
                      float* out) {
  for (std::size_t i = 0; i < rows; ++i) {
    const PairCost* row = table + i * columns;
    Lanes best0 = all(std::numeric_limits<float>::infinity()), best1 = best0, best2 = best0, best3 = best0;
    std::size_t j = 0;
    for (; j + 2 * kCosts <= columns; j += 2 * kCosts) {
      const Costs left = load(row + j), right = load(row + j + kCosts);
      best0 = minimum(best0, left.first + load(a + j));
      best1 = minimum(best1, left.second + load(a + j + kLanes));
      best2 = minimum(best2, right.first + load(a + j + 2 * kLanes));
      best3 = minimum(best3, right.second + load(a + j + 3 * kLanes));
    }
    for (; j + kCosts <= columns; j += kCosts) {
      const Costs costs = load(row + j);
      best0 = minimum(best0, costs.first + load(a + j));
      best1 = minimum(best1, costs.second + load(a + j + kLanes));
    }
    const Lanes best = minimum(minimum(best0, best1), minimum(best2, best3));
    float smallest = std::min(std::min(best[0], best[1]), std::min(best[2], best[3]));
    for (; j < columns; ++j) smallest = std::min(smallest, row[j] + a[j]);
    out[i] = smallest;
  }
}

}  // namespace freshet::query
