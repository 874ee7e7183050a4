#include "query/benchmark/measured_index.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>

namespace freshet::query {

std::vector<std::vector<ScoredPatch>> search_each(
    std::span<const PieceQuery> queries,
    const std::function<std::vector<ScoredPatch>(const PieceQuery&, std::size_t)>& one) {
  std::vector<std::vector<ScoredPatch>> answers(queries.size());
  oneapi::tbb::parallel_for(std::size_t{0}, queries.size(),
                            [&](std::size_t i) { answers[i] = one(queries[i], i); });
  return answers;
}

std::vector<ScoredPatch> search_widening(std::size_t rows, std::size_t k, const SearchFilter& search_filter,
                                         std::size_t query_number,
                                         const std::function<std::vector<ScoredPatch>(std::size_t)>& ask) {
  k = std::min(k, rows);
  if (k == 0) return {};
  for (std::size_t asked = k;; asked = std::min(rows, 4 * asked)) {
    std::vector<ScoredPatch> scored_patches = ask(asked);
    std::erase_if(scored_patches,
                  [&](const ScoredPatch& scored) { return !search_filter.admits(query_number, scored.row); });
    if (scored_patches.size() < k && asked < rows) continue;
    std::sort(scored_patches.begin(), scored_patches.end(), better);
    if (scored_patches.size() > k) scored_patches.resize(k);
    return scored_patches;
  }
}

}  // namespace freshet::query
