#include "query/index/bit_sums.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

namespace freshet::query {
namespace {

using Column = std::array<RowBits, PyramidSums::kGroups>;

bool bit(const Column& column, std::size_t row) {
  return (column[row / RowBits::kRows].words[row / 64 % 8] >> row % 64 & 1) != 0;
}

// Columns of random bits, a tenth of them full, so that sums reach their ends.
std::vector<Column> random_columns(std::size_t count, std::mt19937_64& random) {
  std::vector<Column> columns(count);
  for (Column& column : columns) {
    const bool full = random() % 10 == 0;
    for (RowBits& bits : column)
      for (std::uint64_t& word : bits.words) word = full ? ~std::uint64_t{0} : random() | random();
  }
  return columns;
}

std::vector<const RowBits*> pointers(const std::vector<Column>& columns) {
  std::vector<const RowBits*> all;
  for (const Column& column : columns) all.push_back(column.data());
  return all;
}

TEST(PyramidSums, AreTheSumsOfAddingBitByBit) {
  std::mt19937_64 random(3);
  const auto sums = std::make_unique<PyramidSums>();
  for (const auto& [whole, quarters] :
       std::vector<std::pair<std::size_t, std::size_t>>{{0, 0}, {1, 0}, {0, 9}, {7, 8}, {81, 81}, {40, 23}}) {
    const auto level0 = random_columns(whole, random), level1 = random_columns(quarters, random);
    for (const std::size_t groups : {std::size_t{1}, PyramidSums::kGroups}) {
      const std::size_t rows = groups * RowBits::kRows;
      sums->add_up(pointers(level0), pointers(level1), groups);
      std::vector<std::uint32_t> bounds(rows);
      for (std::size_t row = 0; row < rows; ++row) {
        std::uint32_t i0 = 0, i1 = 0;
        for (const Column& column : level0) i0 += bit(column, row);
        for (const Column& column : level1) i1 += bit(column, row);
        ASSERT_EQ(sums->sum_of(row), i0 + i1);
        bounds[row] = i0 + 3 * i1;
      }
      for (const std::uint32_t score : {0u, 1u, 50u, 128u, 200u, 256u, 324u, 325u}) {
        PyramidSums::Mask mask;
        for (std::uint64_t& word : mask) word = random();
        const PyramidSums::Mask asked = mask;
        std::size_t expected = 0;
        const std::size_t kept = sums->keep_reaching(score, groups, mask);
        for (std::size_t row = 0; row < rows; ++row) {
          const bool keeps = (asked[row / 64] >> row % 64 & 1) != 0 && bounds[row] >= score;
          ASSERT_EQ((mask[row / 64] >> row % 64 & 1) != 0, keeps) << row << ' ' << score;
          expected += keeps;
        }
        EXPECT_EQ(kept, expected);
      }
    }
  }
}

}  // namespace
}  // namespace freshet::query
