// query/index/fine_words.h — a query's words on the pyramid's finest level, to be compared with word maps.
#pragma once

#include <array>
#include <cstdint>

#include "query/index/candidate_index.h"

namespace freshet::query {

/// The 16 cells of level 2, of 4 to 9 points each.
///
/// A point of a row counts when its word is in the query's cell more often than it was at earlier points of
/// the row's cell. That adds up to the histogram intersection, and all 81 points are looked at side by side.
///
/// Word   std::uint8_t or std::uint16_t, as in the rows.
template <class Word>
class FineWords {
 public:
  /// Words from word_count on are in no row and do not count.
  FineWords(const PieceQuery& query, std::size_t word_count);

  /// I2. map: a row's 81 words. Cost: 20 ns with AVX2.
  std::uint32_t intersection(const Word* map) const;

 private:
  static constexpr std::size_t kPadded = 96, kMaxInCell = 9;
  // For each point the query's words in its cell, one after another, and whether there are so many.
  std::array<std::array<Word, kPadded>, kMaxInCell> words_{}, is_there_{};
};

}  // namespace freshet::query
