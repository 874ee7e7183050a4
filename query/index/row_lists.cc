#include "query/index/row_lists.h"

#include <oneapi/tbb/parallel_for.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <new>
#include <utility>

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

// Which lists are columns is decided on evenly spread rows, on all of them where there are few. A list that is judged
// wrongly is only longer than it might be.
constexpr std::size_t kSampledRows = std::size_t{1} << 16;
constexpr std::uint32_t kNumbers = 0xffffffff;  // no column: a list of numbers

// A row of a block that belongs to a list of numbers is kept as the list, then the row.
constexpr unsigned kRowBits = 14;
static_assert(kBlockRows == std::size_t{1} << kRowBits);
static_assert(RowLists::kCells * 256 * 81 < std::size_t{1} << (32 - kRowBits));

}  // namespace

RowColumns::RowColumns(std::size_t count) : count_(count) {
  if (count == 0) return;
  const std::size_t bytes = count * sizeof(RowBits);
  void* const at = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (at == MAP_FAILED) throw std::bad_alloc();
  madvise(at, bytes, MADV_HUGEPAGE);  // where it is refused, it is slower
  data_ = {static_cast<RowBits*>(at), Unmap{bytes}};
}

void RowColumns::Unmap::operator()(RowBits* at) const { munmap(at, bytes); }

RowLists::RowLists(std::span<const vision::WordMap> words, std::size_t word_count)
    : words_(word_count), places_(kCells * word_count * kMaxCount) {
  const std::vector<std::uint32_t> column_of = choose_columns(words);
  // Bits go to their columns at once; numbers are collected block by block, as it is not known how many there are.
  const std::size_t blocks = (words.size() + kBlockRows - 1) / kBlockRows;
  std::vector<std::vector<std::uint32_t>> few(blocks);
  oneapi::tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    Occurrences occurrences;
    const std::size_t first = b * kBlockRows, end = std::min(first + kBlockRows, words.size());
    for (std::size_t row = first; row < end; ++row) {
      RowBits* const group = columns_.data() + row / RowBits::kRows;
      const std::size_t word_of_bits = row / 64 % 8;
      const std::uint64_t bit = std::uint64_t{1} << row % 64;
      occurrences.visit(words[row], [&](std::size_t cell, std::size_t word, std::size_t n) {
        const std::size_t i = place_of(cell, word, n);
        if (const std::uint32_t number = column_of[i]; number != kNumbers)
          group[number * column_groups_].words[word_of_bits] |= bit;
        else
          few[b].push_back(static_cast<std::uint32_t>(i << kRowBits | (row - first)));
      });
    }
  });
  put_numbers(few);
}

std::vector<std::uint32_t> RowLists::choose_columns(std::span<const vision::WordMap> words) {
  std::vector<std::uint32_t> column_of(places_.size(), kNumbers);
  std::vector<std::uint32_t> lengths(places_.size());
  const std::size_t sampled = std::min(words.size(), kSampledRows);
  Occurrences occurrences;
  for (std::size_t i = 0; i < sampled; ++i)
    occurrences.visit(
        words[i * words.size() / sampled],
        [&](std::size_t cell, std::size_t word, std::size_t n) { ++lengths[place_of(cell, word, n)]; });
  // An odd number of cache lines: columns that lie a power of two apart would fight for the same places of
  // the cache.
  column_groups_ = (words.size() + RowBits::kRows - 1) / RowBits::kRows | 1;
  std::uint32_t columns = 0;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (lengths[i] * kFewOf <= sampled) continue;
    column_of[i] = columns;
    places_[i] = {column_groups_ * columns++, kColumn};
  }
  columns_ = RowColumns(columns * column_groups_);
  return column_of;
}

void RowLists::put_numbers(std::span<std::vector<std::uint32_t>> few) {
  for (const auto& of_block : few)
    for (const std::uint32_t one : of_block) ++places_[one >> kRowBits].count;
  std::size_t numbers = 0;
  for (Place& place : places_) {
    if (place.count == kColumn) continue;
    place.at = numbers;
    numbers += std::exchange(place.count, 0);
  }
  rows_.resize(numbers);
  for (std::size_t b = 0; b < few.size(); ++b) {
    for (const std::uint32_t one : few[b]) {
      Place& place = places_[one >> kRowBits];
      rows_[place.at + place.count++] =
          static_cast<std::uint32_t>(b * kBlockRows + (one & ((1u << kRowBits) - 1)));
    }
    few[b] = {};
  }
}

std::size_t RowLists::bytes() const {
  return places_.capacity() * sizeof(Place) + columns_.size() * sizeof(RowBits) +
         rows_.capacity() * sizeof(std::uint32_t);
}

}  // namespace freshet::query
