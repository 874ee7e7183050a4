// query/index/exact_index.h — exact candidate search by inverted lists over the bins of spatial pyramids.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "query/index/candidate_index.h"
#include "query/index/row_lists.h"

namespace freshet::query {

/// Finds exactly what comparing the query with every row by vision::intersection would find,
/// in the same order.
///
/// Levels 0 and 1 of the pyramid are inverted lists, most of them columns of bits, and 512 rows' sums grow at
/// a time (row_lists.h, bit_sums.h). They bound what a row can reach on all levels, I0 + 3 I1; only rows that
/// can still be among the best, one in fifty, are compared on level 2 by their word maps (fine_words.h).
/// Blocks of 16384 rows are the outer loop, so that a block's lists come into the cache once for many pieces.
/// Memory: 460 bytes per row.
class ExactIndex final : public CandidateIndex {
 public:
  /// words     borrowed: must live as long as the index. word_count 1..vision::kMaxWords.
  /// Throws    Error{kDamaged} when a word is not below word_count.
  ExactIndex(vision::WordMaps words, int word_count);
  std::size_t rows() const override { return words_.size(); }
  std::size_t bytes() const { return lists_.bytes(); }
  std::vector<std::vector<ScoredPatch>> search(std::span<const PieceQuery> queries, std::size_t k,
                                               const SearchFilter& search_filter = {}) const override;

 private:
  template <class Word>
  std::vector<std::vector<ScoredPatch>> search_words(std::span<const Word> words,
                                                     std::span<const PieceQuery> queries, std::size_t k,
                                                     const SearchFilter& search_filter) const;

  vision::WordMaps words_;
  std::size_t word_count_;
  RowLists lists_;
};

}  // namespace freshet::query
