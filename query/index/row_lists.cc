#include "query/index/row_lists.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace freshet::query {
namespace {

constexpr int kPoints = vision::kGridSide * vision::kGridSide;
constexpr std::size_t kBlockRows = PyramidSums::kRows;

// Calls visit(cell, word, n) for each point on levels 0 and 1: the word's n-th time in that cell.
class Occurrences {
 public:
  template <class Visit>
  void visit(const vision::WordMap& map, Visit&& visit) {
    static const auto kQuarters = [] {
      std::array<std::uint8_t, kPoints> cells;
      for (int point = 0; point < kPoints; ++point)
        cells[point] = static_cast<std::uint8_t>(
            vision::cells_of(point % vision::kGridSide, point / vision::kGridSide)[1]);
      return cells;
    }();
    counts_.fill(0);
    for (int point = 0; point < kPoints; ++point) {
      const std::size_t word = map[point], quarter = kQuarters[point];
      visit(std::size_t{0}, word, ++counts_[word]);
      visit(quarter, word, ++counts_[quarter * 256 + word]);
    }
  }

 private:
  std::array<std::uint8_t, RowLists::kCells * 256> counts_;
};

}  // namespace

RowLists::RowLists(std::span<const vision::WordMap> words, std::size_t word_count)
    : words_(word_count), places_(kCells * word_count * kMaxCount) {
  const std::size_t blocks = (words.size() + kBlockRows - 1) / kBlockRows;
  const auto block = [&](std::size_t b) {
    return words.subspan(b * kBlockRows, std::min(kBlockRows, words.size() - b * kBlockRows));
  };
  const auto place_of = [&](std::size_t cell, std::size_t word, std::size_t n) {
    return (cell * words_ + word) * kMaxCount + n - 1;
  };
  // How long each list is in each block; then, where it goes on in that block.
  std::vector<std::uint32_t> lengths(blocks * places_.size());
  oneapi::tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    std::uint32_t* const length = lengths.data() + b * places_.size();
    Occurrences occurrences;
    for (const vision::WordMap& map : block(b))
      occurrences.visit(
          map, [&](std::size_t cell, std::size_t word, std::size_t n) { ++length[place_of(cell, word, n)]; });
  });
  std::size_t columns = 0, numbers = 0;
  // An odd number of cache lines: columns that lie a power of two apart would fight for the same places of
  // the cache.
  const std::size_t column = (words.size() + RowBits::kRows - 1) / RowBits::kRows | 1;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    std::size_t count = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::uint32_t here = lengths[b * places_.size() + i];
      lengths[b * places_.size() + i] = static_cast<std::uint32_t>(count);
      count += here;
    }
    if (count * kFewOf > words.size()) {
      places_[i] = {columns, kColumn};
      columns += column;
    } else {
      places_[i] = {numbers, static_cast<std::uint32_t>(count)};
      numbers += count;
    }
  }
  bits_.resize(columns);
  rows_.resize(numbers);
  oneapi::tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    std::uint32_t* const next = lengths.data() + b * places_.size();
    Occurrences occurrences;
    std::size_t row = b * kBlockRows;
    for (const vision::WordMap& map : block(b)) {
      occurrences.visit(map, [&](std::size_t cell, std::size_t word, std::size_t n) {
        const std::size_t i = place_of(cell, word, n);
        const Place& place = places_[i];
        if (place.count == kColumn)
          bits_[place.at + row / RowBits::kRows].words[row / 64 % 8] |= std::uint64_t{1} << row % 64;
        else
          rows_[place.at + next[i]++] = static_cast<std::uint32_t>(row);
      });
      ++row;
    }
  });
}

std::size_t RowLists::bytes() const {
  return places_.capacity() * sizeof(Place) + bits_.capacity() * sizeof(RowBits) +
         rows_.capacity() * sizeof(std::uint32_t);
}

}  // namespace freshet::query
