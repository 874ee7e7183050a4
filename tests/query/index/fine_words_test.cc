#include "query/index/fine_words.h"

#include <gtest/gtest.h>

#include "tests/query/index/random_words.h"

namespace freshet::query {
namespace {

// Level 2 of vision::intersection, counted cell by cell.
std::uint32_t obvious(const PieceQuery& query, const vision::WordMap& map, int words) {
  std::uint32_t sum = 0;
  for (int cell = 5; cell < vision::kPyramidCells; ++cell)
    for (int word = 0; word < words; ++word) {
      std::uint32_t asked = 0, held = 0;
      for (int point = 0; point < 81; ++point) {
        if (vision::cells_of(point % 9, point / 9)[2] != cell) continue;
        asked += query.words[point] == word && query.mask[point] != 0;
        held += map[point] == word;
      }
      sum += std::min(asked, held);
    }
  return sum;
}

template <class Word>
void compare_with_counting(std::initializer_list<int> word_counts) {
  std::mt19937_64 random(12);
  for (const int words : word_counts) {
    const auto rows = random_words({.rows = 20, .words = words, .clusters = 4, .seed = 9});
    for (std::size_t i = 0; i < 20; ++i) {
      PieceQuery query = whole(rows[i]);
      if (i % 3 != 0)
        for (auto& counts : query.mask) counts = random() % (i % 3 + 1) != 0;
      const FineWords<Word> fine(query, static_cast<std::size_t>(words));
      for (std::size_t row = 0; row < rows.size(); ++row) {
        const vision::WordMap map = rows[row];
        std::array<Word, 81> narrow;
        std::transform(map.begin(), map.end(), narrow.begin(),
                       [](auto word) { return static_cast<Word>(word); });
        ASSERT_EQ(fine.intersection(narrow.data()), obvious(query, map, words));
      }
    }
  }
}

TEST(FineWords, GiveTheIntersectionThatCountingGives) {
  compare_with_counting<std::uint8_t>({1, 3, 20, 256});
  compare_with_counting<std::uint16_t>({1, 20, 500, vision::kMaxWords});
}

TEST(FineWords, PassOverWordsThatTheCodebookLacks) {
  const auto rows = random_words({.rows = 2, .words = 10});
  PieceQuery query = whole(rows[0]);
  query.words.fill(10);
  const vision::WordMap row = rows[0];
  EXPECT_EQ(FineWords<std::uint16_t>(query, 10).intersection(row.data()), 0u);
}

}  // namespace
}  // namespace freshet::query
