#include "query/benchmark/measured_index.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>

namespace freshet::query {

std::vector<std::vector<Hit>> search_each(
    std::span<const PieceQuery> queries,
    const std::function<std::vector<Hit>(const PieceQuery&, std::size_t)>& one) {
  std::vector<std::vector<Hit>> answers(queries.size());
  oneapi::tbb::parallel_for(std::size_t{0}, queries.size(),
                            [&](std::size_t i) { answers[i] = one(queries[i], i); });
  return answers;
}

std::vector<Hit> search_widening(std::size_t rows, std::size_t k, const Admission& admission,
                                 std::size_t query_number,
                                 const std::function<std::vector<Hit>(std::size_t)>& ask) {
  k = std::min(k, rows);
  if (k == 0) return {};
  for (std::size_t asked = k;; asked = std::min(rows, 4 * asked)) {
    std::vector<Hit> hits = ask(asked);
    std::erase_if(hits, [&](const Hit& hit) { return !admission.admits(query_number, hit.row); });
    if (hits.size() < k && asked < rows) continue;
    std::sort(hits.begin(), hits.end(), better);
    if (hits.size() > k) hits.resize(k);
    return hits;
  }
}

}  // namespace freshet::query
