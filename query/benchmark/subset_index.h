// query/benchmark/subset_index.h — an index of some rows of a table, that speaks in the table's numbers.
#pragma once

#include <span>

#include "query/index/candidate_index.h"

namespace freshet::query {

/// Borrows both.
class SubsetIndex final : public CandidateIndex {
 public:
  /// rows         of the table, ascending: row i of `inner` is row rows[i] of the table.
  /// table_rows   how many the table has.
  SubsetIndex(const CandidateIndex& inner, std::span<const stored::Row> rows, std::size_t table_rows);
  std::size_t rows() const override { return table_rows_; }
  std::vector<std::vector<ScoredPatch>> search(std::span<const PieceQuery> queries, std::size_t k,
                                               const SearchFilter& search_filter = {}) const override;

 private:
  const CandidateIndex& inner_;
  std::span<const stored::Row> rows_;
  std::size_t table_rows_;
};

/// A search filter in the numbers of a subset. Owns what it names, except the windows.
class SubsetFilter {
 public:
  SubsetFilter(const SearchFilter& search_filter, std::span<const stored::Row> rows);
  SubsetFilter(const SubsetFilter&) = delete;
  SubsetFilter& operator=(const SubsetFilter&) = delete;
  const SearchFilter& search_filter() const& { return search_filter_; }
  const SearchFilter& search_filter() const&& = delete;

 private:
  RowFilter filter_;
  std::vector<float> mean_u_, mean_v_;
  SearchFilter search_filter_;
};

}  // namespace freshet::query
