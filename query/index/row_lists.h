// query/index/row_lists.h — which rows hold a visual word at least n times in a cell of the pyramid.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "query/index/bit_sums.h"
#include "vision/spatial_pyramid.h"

namespace freshet::query {

/// Rows' bits, none of them set to begin with. Memory that is first touched where it is written, by all threads, in
/// pages as large as there are: a row's bits go to some hundred columns, each in another page.
class RowColumns {
 public:
  explicit RowColumns(std::size_t count = 0);
  RowBits* data() { return data_.get(); }
  const RowBits* data() const { return data_.get(); }
  std::size_t size() const { return count_; }

 private:
  struct Unmap {
    std::size_t bytes;
    void operator()(RowBits* at) const;
  };
  std::unique_ptr<RowBits[], Unmap> data_;
  std::size_t count_ = 0;
};

/// Inverted lists over the bins of the pyramid's levels 0 and 1 (cells 0 to 4).
///
/// For each bin and each n from 1 on there is a list of the rows whose bin holds at least n. A query whose
/// bin holds m takes the lists 1..m: that is min(a, b) without a comparison. A list of many rows is a column
/// of bits, a row after the other; a list of few is those rows' numbers.
class RowLists {
 public:
  static constexpr std::size_t kCells = 5;
  /// Lists of so many words.
  static constexpr std::size_t places_of(std::size_t words) {
    return words * (kMaxCount0 + (kCells - 1) * kMaxCount1);
  }
  static constexpr std::size_t kFewOf = 64;  // a list of one row in so many, or fewer, is kept as numbers

  /// words   below word_count, which is at most vision::kMaxWords.
  /// Cost    1 us of CPU per row, shared by all threads, beside what the system takes for new pages; 460 bytes per row,
  ///         and some 80 more while they are made.
  RowLists(vision::WordMaps words, std::size_t word_count);

  /// A list: bits of all rows, or where that is null, numbers in rising order.
  struct List {
    const RowBits* bits;
    std::span<const std::uint32_t> rows;
  };
  /// Of the rows with at least n of a word in a cell; empty when there is none. n   from 1 to the points of the cell.
  List list(std::size_t cell, std::size_t word, std::size_t n) const {
    const Place& place = places_[place_of(cell * words_ + word, n)];
    if (place.count == kColumn) return {columns_.data() + place.at, {}};
    return {nullptr, {rows_.data() + place.at, place.count}};
  }
  std::size_t bytes() const;

 private:
  static constexpr std::size_t kMaxCount0 = 81,
                               kMaxCount1 = 25;  // points of a cell of level 0, of level 1: 9 x 9, 5 x 5
  static constexpr std::uint32_t kColumn = 0xffffffff;
  struct Place {
    std::size_t at = 0;       // into columns_ or rows_
    std::uint32_t count = 0;  // of numbers; kColumn: bits
  };
  /// bin   cell * words_ + word.
  std::size_t place_of(std::size_t bin, std::size_t n) const {
    if (bin < words_) return bin * kMaxCount0 + n - 1;
    return words_ * kMaxCount0 + (bin - words_) * kMaxCount1 + n - 1;
  }
  /// By place, its column, and none where numbers are fewer; what is asked for each bit is small. Makes the columns.
  std::vector<std::uint32_t> choose_columns(vision::WordMaps words);
  /// few   by block of rows: which list, and which row.
  void put_numbers(std::span<std::vector<std::uint32_t>> few);

  std::size_t words_, column_groups_ = 0;
  std::vector<Place> places_;
  RowColumns columns_;
  std::vector<std::uint32_t> rows_;
};

}  // namespace freshet::query
