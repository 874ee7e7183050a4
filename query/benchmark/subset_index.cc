#include "query/benchmark/subset_index.h"

#include <cassert>

namespace freshet::query {

SubsetIndex::SubsetIndex(const CandidateIndex& inner, std::span<const Row> rows, std::size_t table_rows)
    : inner_(inner), rows_(rows), table_rows_(table_rows) {
  assert(inner.rows() == rows.size());
}

std::vector<std::vector<Hit>> SubsetIndex::search(std::span<const PieceQuery> queries, std::size_t k,
                                                  const Admission& admission) const {
  check(admission, queries.size(), table_rows_);
  const SubsetAdmission own(admission, rows_);
  auto answers = inner_.search(queries, k, own.admission());
  for (auto& hits : answers)
    for (Hit& hit : hits) hit.row = rows_[hit.row];
  return answers;
}

SubsetAdmission::SubsetAdmission(const Admission& admission, std::span<const Row> rows)
    : filter_(rows.size()) {
  if (admission.rows != nullptr) {
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (!admission.rows->allows(rows[i])) filter_.forbid(i);
    admission_.rows = &filter_;
  }
  if (admission.windows.empty()) return;
  for (const Row row : rows) {
    mean_u_.push_back(admission.mean_u[row]);
    mean_v_.push_back(admission.mean_v[row]);
  }
  admission_.mean_u = mean_u_;
  admission_.mean_v = mean_v_;
  admission_.windows = admission.windows;
}

}  // namespace freshet::query
