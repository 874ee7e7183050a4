// query/index/bit_sums.h — sums over many columns of one bit per row, 512 rows at a time.
//
// A sum is kept across bit planes: plane p holds bit p of the sums of 512 rows. Adding a column is then a
// handful of logical operations for all 512 rows (carry-save adders; Harley and Seal). Row by row it would be
// a load, an addition and a store for each row that is set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace freshet::query {

/// A bit per row; row r is bit r % 64 of word r / 64, as in RowFilter.
struct alignas(64) RowBits {
  static constexpr std::size_t kRows = 512;
  std::array<std::uint64_t, 8> words;
};

/// For the rows of one block: how much of a query's words they hold in the first two levels of the pyramid,
/// and how much they can hold in all three.
///
/// Points that meet in a cell of level 2 also meet in the cell of level 1 around it: I2 <= I1. The levels'
/// weights are 1, 1 and 2, so that the whole intersection is at most I0 + 3 I1.
class PyramidSums {
 public:
  static constexpr std::size_t kGroups = 32;  // of 512 rows: 35 KB of planes
  static constexpr std::size_t kRows = kGroups * RowBits::kRows;
  using Mask = std::array<std::uint64_t, kRows / 64>;

  /// level0, level1   a column of `groups` RowBits for each unit of the query's histograms; at most 81 each.
  /// groups           that hold rows, at most kGroups; the others are left as they are.
  void add_up(std::span<const RowBits* const> level0, std::span<const RowBits* const> level1,
              std::size_t groups);

  /// Rows whose bound reaches `score`. mask: the rows to look at in, those that reach it out.
  /// Returns   how many.
  std::size_t keep_reaching(std::uint32_t score, std::size_t groups, Mask& mask) const;

  /// I0 + I1 of a row of the block.
  std::uint32_t sum_of(std::size_t row) const {
    const auto& planes = sum_[row / RowBits::kRows];
    const std::size_t word = row / 64 % 8, bit = row % 64;
    std::uint32_t sum = 0;
    for (std::size_t plane = 0; plane < planes.size(); ++plane)
      sum |= static_cast<std::uint32_t>(planes[plane].words[word] >> bit & 1) << plane;
    return sum;
  }

 private:
  std::array<std::array<RowBits, 8>, kGroups> sum_;    // I0 + I1 <= 162
  std::array<std::array<RowBits, 9>, kGroups> bound_;  // I0 + 3 I1 <= 324
};

}  // namespace freshet::query
