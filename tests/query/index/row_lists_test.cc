#include "query/index/row_lists.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/query/index/random_words.h"

namespace freshet::query {
namespace {

std::vector<std::uint32_t> rows_of(const RowLists::List& list, std::size_t rows) {
  if (list.bits == nullptr) return {list.rows.begin(), list.rows.end()};
  std::vector<std::uint32_t> all;
  for (std::size_t row = 0; row < rows; ++row)
    if ((list.bits[row / RowBits::kRows].words[row / 64 % 8] >> row % 64 & 1) != 0)
      all.push_back(static_cast<std::uint32_t>(row));
  return all;
}

TEST(RowLists, HoldTheRowsThatCountingFinds) {
  for (const int words : {1, 30, 256, 700}) {
    const auto rows = random_words({.rows = 20000, .words = words, .clusters = 10, .seed = 6});
    const RowLists lists(rows, static_cast<std::size_t>(words));
    std::size_t columns = 0, numbers = 0;
    for (std::size_t cell = 0; cell < RowLists::kCells; ++cell)
      for (int word = 0; word < words; word += std::max(1, words / 7)) {
        std::vector<std::vector<std::uint32_t>> expected(82);
        for (std::uint32_t row = 0; row < rows.size(); ++row) {
          std::size_t times = 0;
          const vision::WordMap map = rows[row];
          for (int point = 0; point < 81; ++point) {
            const auto cells = vision::cells_of(point % 9, point / 9);
            times += map[point] == word &&
                     (cells[0] == static_cast<int>(cell) || cells[1] == static_cast<int>(cell));
          }
          for (std::size_t n = 1; n <= times; ++n) expected[n].push_back(row);
        }
        for (std::size_t n = 1; n <= (cell == 0 ? 81 : 25); ++n) {  // as many points as it has
          const RowLists::List list = lists.list(cell, static_cast<std::size_t>(word), n);
          EXPECT_EQ(rows_of(list, rows.size()), expected[n]);
          (list.bits != nullptr ? columns : numbers) += !expected[n].empty();
        }
      }
    EXPECT_GT(columns, 0u);
    if (words > 1) {
      EXPECT_GT(numbers, 0u);
    }
  }
}

}  // namespace
}  // namespace freshet::query
