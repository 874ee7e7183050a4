#include "query/index/candidate_index.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cassert>

#include "freshet/error.h"

namespace freshet::query {

int max_score(const PieceQuery& query) {
  int points = 0;
  for (const std::uint8_t counts : query.mask) points += counts != 0;
  int weight = 0;
  for (const int level : vision::kLevelWeights) weight += level;
  return points * weight;
}

RowFilter::RowFilter(std::size_t rows, bool allowed)
    : rows_(rows), bits_((rows + 63) / 64, allowed ? ~std::uint64_t{0} : 0) {
  if (allowed && rows % 64 != 0) bits_.back() >>= 64 - rows % 64;
}

std::size_t RowFilter::count() const {
  std::size_t sum = 0;
  for (const std::uint64_t bits : bits_) sum += static_cast<std::size_t>(std::popcount(bits));
  return sum;
}

bool RowFilter::empty(std::size_t first, std::size_t count) const {
  const auto from = bits_.begin() + static_cast<std::ptrdiff_t>(first / 64);
  const auto to = bits_.begin() + static_cast<std::ptrdiff_t>((first + count + 63) / 64);
  return std::all_of(from, to, [](std::uint64_t bits) { return bits == 0; });
}

void check([[maybe_unused]] const SearchFilter& search_filter, [[maybe_unused]] std::size_t queries,
           [[maybe_unused]] std::size_t rows) {
  assert(search_filter.rows == nullptr || search_filter.rows->rows() == rows);
  assert(search_filter.windows.empty() ||
         (search_filter.windows.size() == queries && search_filter.mean_u.size() == rows &&
          search_filter.mean_v.size() == rows));
}

void check_words(vision::WordMaps words, int word_count) {
  constexpr std::size_t kRows = 16384;
  const std::size_t parts = (words.size() + kRows - 1) / kRows;
  oneapi::tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
    const auto rows = words.subspan(part * kRows, std::min(kRows, words.size() - part * kRows));
    // Of all: as fast as memory, where row by row is not.
    const int most = rows.visit([](auto all) {
      auto largest = all[0];
      for (const auto word : all) largest = std::max(largest, word);
      return int{largest};
    });
    if (most < word_count) return;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const vision::WordMap map = rows[row];
      const int max_word = *std::max_element(map.begin(), map.end());
      if (max_word < word_count) continue;
      throw Error(
          ErrorKind::kDamaged, "column patch.words, row " + std::to_string(part * kRows + row),
          "word " + std::to_string(max_word) + " where the codebook has " + std::to_string(word_count),
          "Build the index again: freshet index --rebuild");
    }
  });
}

}  // namespace freshet::query
