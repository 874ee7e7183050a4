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
constexpr std::size_t kWords = RowBits::kRows / 64;

// Bins of levels 0 and 1, a word in a cell: cell * word count + word.
constexpr std::size_t kMaxBins = RowLists::kCells * vision::kMaxWords;

// Calls visit(bin, n) for each point on levels 0 and 1: the word's n-th time in that cell.
class Occurrences {
 public:
  explicit Occurrences(std::size_t word_count) : bins_(RowLists::kCells * word_count) {
    for (int point = 0; point < kPoints; ++point)
      quarters_[point] = static_cast<std::size_t>(
                             vision::cells_of(point % vision::kGridSide, point / vision::kGridSide)[1]) *
                         word_count;
  }
  template <class Visit>
  void visit(const vision::WordMap& map, Visit&& visit) {
    std::fill_n(counts_.begin(), bins_, std::uint8_t{0});
    for (int point = 0; point < kPoints; ++point) {
      const std::size_t whole = map[point], quarter = quarters_[point] + whole;
      visit(whole, std::size_t{++counts_[whole]});
      visit(quarter, std::size_t{++counts_[quarter]});
    }
  }

 private:
  std::size_t bins_;
  std::array<std::size_t, kPoints> quarters_;  // by point, the first bin of its cell of level 1
  std::array<std::uint8_t, kMaxBins> counts_;
};

// Which lists are columns is decided on evenly spread rows, on all of them where there are few. A list that is judged
// wrongly is only longer than it might be.
constexpr std::size_t kSampledRows = std::size_t{1} << 16;
constexpr std::size_t kParts = 16;              // that numbers are put into lists in, at once
constexpr std::uint32_t kNumbers = 0xffffffff;  // no column: a list of numbers

// The columns of a word's first times in a cell, as nearly all are that are asked for: a small table, of 8 KB for 200
// words, which stays in the first cache.
class FirstTimes {
 public:
  static constexpr std::size_t kTimes = 3;
  /// none   what is answered where there is no column, or n is more than kTimes.
  template <class ColumnOf>
  FirstTimes(std::size_t word_count, std::size_t none, ColumnOf&& column_of) {
    columns_.fill(static_cast<std::uint16_t>(none));
    for (std::size_t bin = 0; bin < RowLists::kCells * word_count; ++bin)
      for (std::size_t n = 1; n <= kTimes; ++n)
        if (const std::uint32_t column = column_of(bin, n); column != kNumbers)
          columns_[bin * (kTimes + 1) + n - 1] = static_cast<std::uint16_t>(column);
  }
  std::size_t column(std::size_t bin, std::size_t n) const {
    return columns_[bin * (kTimes + 1) + std::min(n, kTimes + 1) - 1];
  }

 private:
  std::array<std::uint16_t, (kTimes + 1) * kMaxBins> columns_;
};
static_assert(2 * kPoints * RowLists::kFewOf < 0xffff, "columns, of which each has one row in kFewOf");

// What has none of these columns is put aside, for to branch at each point takes longer: a row of 64, n and a bin.
constexpr unsigned kAsideN = 6, kAsideBin = kAsideN + 7;

// A row of a block that belongs to a list of numbers is kept as the list, then the row.
constexpr unsigned kRowBits = 14;
static_assert(kBlockRows == std::size_t{1} << kRowBits);
static_assert(RowLists::places_of(vision::kMaxWords) < std::size_t{1} << (32 - kRowBits));

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

RowLists::RowLists(vision::WordMaps words, std::size_t word_count)
    : words_(word_count), places_(places_of(word_count)) {
  const std::vector<std::uint32_t> column_of = choose_columns(words);
  // Numbers are collected block by block, as it is not known how many there are.
  const std::size_t blocks = (words.size() + kBlockRows - 1) / kBlockRows;
  const std::size_t columns = column_groups_ == 0 ? 0 : columns_.size() / column_groups_;
  std::vector<std::vector<std::uint32_t>> few(blocks);
  const FirstTimes first_times(word_count, columns,
                               [&](std::size_t bin, std::size_t n) { return column_of[place_of(bin, n)]; });
  oneapi::tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    Occurrences occurrences(words_);
    // A row's bits go to some hundred columns, each in a page of its own: those of 64 rows are set in memory that lies
    // together and stays in the first cache, and of a group of rows they go to their places a cache line at a time.
    const std::size_t stride = columns + 1;  // the last one is of what has no column
    std::vector<std::uint64_t> group(stride * kWords);
    std::vector<std::uint32_t> aside(64 * 2 * kPoints);
    const std::size_t first = b * kBlockRows, end = std::min(first + kBlockRows, words.size());
    for (std::size_t begin = first; begin < end; begin += RowBits::kRows) {
      std::ranges::fill(group, 0);
      for (std::size_t w = 0; w < kWords && begin + w * 64 < end; ++w) {
        const std::size_t at = begin + w * 64;
        std::uint64_t* const bits = group.data() + w * stride;
        std::uint32_t* last = aside.data();
        for (std::size_t row = 0; row < std::min<std::size_t>(64, end - at); ++row)
          occurrences.visit(words[at + row], [&, columns](std::size_t bin, std::size_t n) {
            const std::size_t column = first_times.column(bin, n);
            bits[column] |= std::uint64_t{1} << row;
            *last = static_cast<std::uint32_t>(bin << kAsideBin | n << kAsideN | row);
            last += column == columns ? 1 : 0;
          });
        for (const std::uint32_t one : std::span(aside.data(), last)) {
          const std::size_t bin = one >> kAsideBin, n = one >> kAsideN & 127, row = one & 63;
          const std::size_t place = place_of(bin, n);
          if (column_of[place] != kNumbers)
            bits[column_of[place]] |= std::uint64_t{1} << row;
          else
            few[b].push_back(static_cast<std::uint32_t>(place << kRowBits | (at + row - first)));
        }
      }
      RowBits* const to = columns_.data() + begin / RowBits::kRows;
      for (std::size_t column = 0; column < columns; ++column) {
        RowBits line;
        for (std::size_t w = 0; w < kWords; ++w) line.words[w] = group[w * stride + column];
        to[column * column_groups_] = line;
      }
    }
  });
  put_numbers(few);
}

std::vector<std::uint32_t> RowLists::choose_columns(vision::WordMaps words) {
  std::vector<std::uint32_t> column_of(places_.size(), kNumbers);
  std::vector<std::uint32_t> lengths(places_.size());
  const std::size_t sampled = std::min(words.size(), kSampledRows);
  Occurrences occurrences(words_);
  for (std::size_t i = 0; i < sampled; ++i)
    occurrences.visit(words[i * words.size() / sampled],
                      [&](std::size_t bin, std::size_t n) { ++lengths[place_of(bin, n)]; });
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
