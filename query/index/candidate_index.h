// query/index/candidate_index.h — for pieces of a picture, the patches of a store that look most like them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "query/index/motion_window.h"
#include "stored/patch_table.h"
#include "vision/spatial_pyramid.h"

namespace freshet::query {

/// What is asked: the words of a piece, and which of its grid points lie in the fluid and count.
struct PieceQuery {
  vision::WordMap words{};
  vision::WordMask mask{};  // 1: counts; at least one point
};

/// A row and its weighted histogram intersection with the query, 0..max_score(query).
struct ScoredPatch {
  stored::Row row = stored::kNoRow;
  std::uint32_t score = 0;
  bool operator==(const ScoredPatch&) const = default;
};

/// Falling score, then rising row: the order of every answer.
inline bool better(const ScoredPatch& a, const ScoredPatch& b) {
  return a.score != b.score ? a.score > b.score : a.row < b.row;
}

/// Weights of all points that count: the largest intersection that there can be (324 without a mask).
int max_score(const PieceQuery& query);

/// Rows that may be candidates, one bit each.
class RowFilter {
 public:
  explicit RowFilter(std::size_t rows, bool allowed = true);
  std::size_t rows() const { return rows_; }
  bool allows(std::size_t row) const { return (bits_[row / 64] >> row % 64 & 1) != 0; }
  void forbid(std::size_t row) { bits_[row / 64] &= ~(std::uint64_t{1} << row % 64); }
  void allow(std::size_t row) { bits_[row / 64] |= std::uint64_t{1} << row % 64; }
  std::size_t count() const;
  std::span<const std::uint64_t> bit_words() const { return bits_; }  // row r is bit r % 64 of word r / 64
  /// Bits of rows [first, first + count), first a multiple of 64: true when none is set.
  bool empty(std::size_t first, std::size_t count) const;

 private:
  std::size_t rows_;
  std::vector<std::uint64_t> bits_;  // bits beyond rows_ are 0
};

/// Which rows may be answers: some for all queries, and for each query those whose mean motion it admits. The
/// conditions hold inside the search, so that a query still gets its k. Borrows all that it names.
struct SearchFilter {
  const RowFilter* rows = nullptr;            // null: all
  std::span<const float> mean_u{}, mean_v{};  // px/s, a value per row; needed with windows
  std::span<const MotionWindow> windows{};    // one per query; empty: any motion

  bool admits(std::size_t query, std::size_t row) const {
    return (rows == nullptr || rows->allows(row)) &&
           (windows.empty() || windows[query].is_any() || windows[query].admits(mean_u[row], mean_v[row]));
  }
};

class CandidateIndex {
 public:
  virtual ~CandidateIndex() = default;
  virtual std::size_t rows() const = 0;
  /// The k best admitted rows of each query, in the order of `better`; fewer where fewer are admitted.
  /// Pieces are shared by all threads; the answer is the same for any number of them. Safe from many threads.
  virtual std::vector<std::vector<ScoredPatch>> search(std::span<const PieceQuery> queries, std::size_t k,
                                                       const SearchFilter& search_filter = {}) const = 0;
};

/// That a filter's parts are as long as the queries and rows they speak of; only we can get that wrong.
void check(const SearchFilter& search_filter, std::size_t queries, std::size_t rows);

/// Throws Error{kDamaged} when a word is not below word_count.
void check_words(vision::WordMaps words, int word_count);

}  // namespace freshet::query
