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
constexpr std::size_t kParts = 16;              // that numbers are put into lists in, at once
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
  // Numbers are collected block by block, as it is not known how many there are.
  const std::size_t blocks = (words.size() + kBlockRows - 1) / kBlockRows;
  const std::size_t columns = column_groups_ == 0 ? 0 : columns_.size() / column_groups_;
  std::vector<std::vector<std::uint32_t>> few(blocks);
  oneapi::tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    Occurrences occurrences;
    // A row's bits go to some hundred columns, each in a page of its own: they are set in a group of rows that lies
    // together, and go to their places a cache line at a time. 4.5 s of CPU for five million rows were 3.4.
    std::vector<RowBits> group(columns);
    const std::size_t first = b * kBlockRows, end = std::min(first + kBlockRows, words.size());
    for (std::size_t begin = first; begin < end; begin += RowBits::kRows) {
      std::ranges::fill(group, RowBits{});
      for (std::size_t row = begin; row < std::min(begin + RowBits::kRows, end); ++row) {
        const std::size_t word_of_bits = row / 64 % 8;
        const std::uint64_t bit = std::uint64_t{1} << row % 64;
        occurrences.visit(words[row], [&](std::size_t cell, std::size_t word, std::size_t n) {
          const std::size_t i = place_of(cell, word, n);
          if (const std::uint32_t number = column_of[i]; number != kNumbers)
            group[number].words[word_of_bits] |= bit;
          else
            few[b].push_back(static_cast<std::uint32_t>(i << kRowBits | (row - first)));
        });
      }
      RowBits* const to = columns_.data() + begin / RowBits::kRows;
      for (std::size_t column = 0; column < columns; ++column) to[column * column_groups_] = group[column];
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
  // Each part of the blocks counts its own, and writes behind the parts before it.
  const std::size_t parts = std::min<std::size_t>(few.size(), kParts);
  const auto block = [&](std::size_t part) { return part * few.size() / parts; };
  std::vector<std::vector<std::uint32_t>> counts(parts);
  oneapi::tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
    counts[part].resize(places_.size());
    for (std::size_t b = block(part); b < block(part + 1); ++b)
      for (const std::uint32_t one : few[b]) ++counts[part][one >> kRowBits];
  });
  std::size_t numbers = 0;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    Place& place = places_[i];
    if (place.count == kColumn) continue;
    place.at = numbers;
    for (auto& of_part : counts) place.count += std::exchange(of_part[i], place.count);
    numbers += place.count;
  }
  rows_.resize(numbers);
  oneapi::tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
    for (std::size_t b = block(part); b < block(part + 1); ++b) {
      for (const std::uint32_t one : few[b]) {
        const std::size_t i = one >> kRowBits;
        rows_[places_[i].at + counts[part][i]++] =
            static_cast<std::uint32_t>(b * kBlockRows + (one & ((1u << kRowBits) - 1)));
      }
      few[b] = {};
    }
  });
}

std::size_t RowLists::bytes() const {
  return places_.capacity() * sizeof(Place) + columns_.size() * sizeof(RowBits) +
         rows_.capacity() * sizeof(std::uint32_t);
}

}  // namespace freshet::query
