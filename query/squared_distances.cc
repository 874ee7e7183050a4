#include "query/squared_distances.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "freshet_vectors.h"

namespace freshet::query {
namespace {

constexpr std::size_t kTile = Panel::kTile;
constexpr std::size_t kRows = 4;  // of `a` at a time: 4 x 8 sums stay in registers

typedef float Lanes __attribute__((vector_size(kTile * sizeof(float))));

// One tile of b against kRows vectors of a, which lie from `a` on in a tile of their own.
FRESHET_WIDE void tile_distances(const float* a, const float* b, std::size_t length, float* out) {
  Lanes sum0{}, sum1{}, sum2{}, sum3{};
  for (std::size_t d = 0; d < length; ++d) {
    Lanes values;
    std::memcpy(&values, b + d * kTile, sizeof values);
    const float* row = a + d * kTile;
    const Lanes difference0 = values - row[0], difference1 = values - row[1];
    const Lanes difference2 = values - row[2], difference3 = values - row[3];
    sum0 += difference0 * difference0;
    sum1 += difference1 * difference1;
    sum2 += difference2 * difference2;
    sum3 += difference3 * difference3;
  }
  std::memcpy(out, &sum0, sizeof sum0);
  std::memcpy(out + kTile, &sum1, sizeof sum1);
  std::memcpy(out + 2 * kTile, &sum2, sizeof sum2);
  std::memcpy(out + 3 * kTile, &sum3, sizeof sum3);
}

}  // namespace

void Panel::resize(std::size_t count, std::size_t length) {
  count_ = count;
  length_ = length;
  values_.assign((count + kTile - 1) / kTile * kTile * length, 0);
}

void squared_distances(const Panel& a, const Panel& b, std::span<float> out) {
  assert(a.length() == b.length() && out.size() == a.count() * b.count());
  float sums[kRows * kTile];
  for (std::size_t j = 0; j < b.count(); j += kTile) {
    const std::size_t columns = std::min(kTile, b.count() - j);
    for (std::size_t i = 0; i < a.count(); i += kRows) {
      tile_distances(a.tile(i / kTile) + i % kTile, b.tile(j / kTile), a.length(), sums);
      for (std::size_t r = 0; r < std::min(kRows, a.count() - i); ++r) {
        std::copy_n(sums + r * kTile, columns, out.data() + (i + r) * b.count() + j);
      }
    }
  }
}

}  // namespace freshet::query
