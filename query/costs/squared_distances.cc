#include "query/costs/squared_distances.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "platform/vectors.h"

namespace freshet::query {
namespace {

// Four vectors of `a` against two of `b` at a time: eight sums stay in registers, and six loads feed eight
// products. 4 x 4 is slower with every width (tried), 2 x 2 by half.
constexpr std::size_t kRows = 4, kColumns = 2;

template <class Value>
using Rows = std::array<const Value*, kRows>;

// out[r * columns + j] = a_r . b_j modulo 2^32. The loop over values is one that compilers know as a dot
// product of 16-bit numbers.
FRESHET_WIDE void dot_products(const Rows<std::int16_t>& a, const std::int16_t* b, std::size_t columns,
                               std::size_t padded, std::uint32_t* out) {
  const std::int16_t *a0 = a[0], *a1 = a[1], *a2 = a[2], *a3 = a[3];
  for (std::size_t j = 0; j < columns; j += kColumns) {
    const std::size_t last = std::min(j + 1, columns - 1);  // an odd column is done twice
    const std::int16_t *b0 = b + j * padded, *b1 = b + last * padded;
    std::uint32_t s00 = 0, s01 = 0, s10 = 0, s11 = 0, s20 = 0, s21 = 0, s30 = 0, s31 = 0;
    for (std::size_t d = 0; d < padded; ++d) {
      s00 += static_cast<std::uint32_t>(std::int32_t{a0[d]} * b0[d]);
      s01 += static_cast<std::uint32_t>(std::int32_t{a0[d]} * b1[d]);
      s10 += static_cast<std::uint32_t>(std::int32_t{a1[d]} * b0[d]);
      s11 += static_cast<std::uint32_t>(std::int32_t{a1[d]} * b1[d]);
      s20 += static_cast<std::uint32_t>(std::int32_t{a2[d]} * b0[d]);
      s21 += static_cast<std::uint32_t>(std::int32_t{a2[d]} * b1[d]);
      s30 += static_cast<std::uint32_t>(std::int32_t{a3[d]} * b0[d]);
      s31 += static_cast<std::uint32_t>(std::int32_t{a3[d]} * b1[d]);
    }
    out[j] = s00, out[columns + j] = s10, out[2 * columns + j] = s20, out[3 * columns + j] = s30;
    out[last] = last == j ? s00 : s01, out[columns + last] = last == j ? s10 : s11;
    out[2 * columns + last] = last == j ? s20 : s21, out[3 * columns + last] = last == j ? s30 : s31;
  }
}

FRESHET_WIDE std::uint32_t square_norm(const std::int16_t* a, std::size_t padded) {
  std::uint32_t sum = 0;
  for (std::size_t d = 0; d < padded; ++d) sum += static_cast<std::uint32_t>(std::int32_t{a[d]} * a[d]);
  return sum;
}

FRESHET_WIDE void to_distances(std::uint32_t norm, const std::uint32_t* norms, const std::uint32_t* dots,
                               std::size_t columns, float unit, Into into, float* out) {
  if (into == Into::kNew) {
    for (std::size_t j = 0; j < columns; ++j)
      out[j] = unit * static_cast<float>(norm + norms[j] - 2 * dots[j]);
  } else {
    for (std::size_t j = 0; j < columns; ++j)
      out[j] += unit * static_cast<float>(norm + norms[j] - 2 * dots[j]);
  }
}

typedef float Lanes __attribute__((vector_size(32)));
constexpr std::size_t kLanes = sizeof(Lanes) / sizeof(float);

// By reference: what passes wide vectors by value differs from width to width.
inline void add_squares(const float* a, const Lanes& b, Lanes& sum) {
  Lanes values;
  std::memcpy(&values, a, sizeof values);
  const Lanes difference = values - b;
  sum += difference * difference;
}

inline float sum_of(const Lanes& lanes) {
  float sum = lanes[0];
  for (std::size_t i = 1; i < kLanes; ++i) sum += lanes[i];
  return sum;
}

// out[r * columns + j] = |a_r - b_j|^2.
FRESHET_WIDE void float_distances(const Rows<float>& a, const float* b, std::size_t columns,
                                  std::size_t padded, float* out) {
  const float *a0 = a[0], *a1 = a[1], *a2 = a[2], *a3 = a[3];
  for (std::size_t j = 0; j < columns; ++j) {
    Lanes s0{}, s1{}, s2{}, s3{};
    for (std::size_t d = 0; d < padded; d += kLanes) {
      Lanes values;
      std::memcpy(&values, b + j * padded + d, sizeof values);
      add_squares(a0 + d, values, s0);
      add_squares(a1 + d, values, s1);
      add_squares(a2 + d, values, s2);
      add_squares(a3 + d, values, s3);
    }
    out[j] = sum_of(s0), out[columns + j] = sum_of(s1);
    out[2 * columns + j] = sum_of(s2), out[3 * columns + j] = sum_of(s3);
  }
}

// The last rows of a set whose size is no multiple of four: its last vector again.
template <class Value>
Rows<Value> rows_from(const Panel<Value>& a, std::size_t first) {
  Rows<Value> rows;
  for (std::size_t r = 0; r < kRows; ++r) rows[r] = a.vector(std::min(first + r, a.count() - 1));
  return rows;
}

}  // namespace

void squared_distances(const Panel<std::int16_t>& a, const Panel<std::int16_t>& b, float unit, Into into,
                       float* out) {
  assert(a.length() == b.length());
  thread_local std::vector<std::uint32_t> norms, dots;
  norms.resize(b.count());
  dots.resize(kRows * b.count());
  for (std::size_t j = 0; j < b.count(); ++j) norms[j] = square_norm(b.vector(j), b.padded());
  for (std::size_t i = 0; i < a.count(); i += kRows) {
    dot_products(rows_from(a, i), b.vector(0), b.count(), b.padded(), dots.data());
    for (std::size_t r = 0; r < std::min(kRows, a.count() - i); ++r)
      to_distances(square_norm(a.vector(i + r), a.padded()), norms.data(), dots.data() + r * b.count(),
                   b.count(), unit, into, out + (i + r) * b.count());
  }
}

void squared_distances(const Panel<float>& a, const Panel<float>& b, float unit, Into into, float* out) {
  assert(a.length() == b.length());
  thread_local std::vector<float> distances;
  distances.resize(kRows * b.count());
  for (std::size_t i = 0; i < a.count(); i += kRows) {
    float_distances(rows_from(a, i), b.vector(0), b.count(), b.padded(), distances.data());
    for (std::size_t r = 0; r < std::min(kRows, a.count() - i); ++r) {
      float* to = out + (i + r) * b.count();
      for (std::size_t j = 0; j < b.count(); ++j) {
        const float distance = unit * distances[r * b.count() + j];
        to[j] = into == Into::kNew ? distance : to[j] + distance;
      }
    }
  }
}

}  // namespace freshet::query
