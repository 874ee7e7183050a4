#include "query/benchmark/subset_index.h"

#include <cassert>

namespace freshet::query {

SubsetIndex::SubsetIndex(const CandidateIndex& inner, std::span<const stored::Row> rows,
                         std::size_t table_rows)
    : inner_(inner), rows_(rows), table_rows_(table_rows) {
  assert(inner.rows() == rows.size());
}

std::vector<std::vector<ScoredPatch>> SubsetIndex::search(std::span<const PieceQuery> queries, std::size_t k,
                                                          const SearchFilter& search_filter) const {
  check(search_filter, queries.size(), table_rows_);
  const SubsetFilter own(search_filter, rows_);
  auto answers = inner_.search(queries, k, own.search_filter());
  for (auto& scored_patches : answers)
    for (ScoredPatch& scored : scored_patches) scored.row = rows_[scored.row];
  return answers;
}

SubsetFilter::SubsetFilter(const SearchFilter& search_filter, std::span<const stored::Row> rows)
    : filter_(rows.size()) {
  if (search_filter.rows != nullptr) {
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (!search_filter.rows->allows(rows[i])) filter_.forbid(i);
    search_filter_.rows = &filter_;
  }
  if (search_filter.windows.empty()) return;
  for (const stored::Row row : rows) {
    mean_u_.push_back(search_filter.mean_u[row]);
    mean_v_.push_back(search_filter.mean_v[row]);
  }
  search_filter_.mean_u = mean_u_;
  search_filter_.mean_v = mean_v_;
  search_filter_.windows = search_filter.windows;
}

}  // namespace freshet::query
