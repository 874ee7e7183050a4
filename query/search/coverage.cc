#include "query/search/coverage.h"

#include <algorithm>
#include <cstddef>

namespace freshet::query {
namespace {

constexpr std::size_t kAsked = 24;  // patches of a clip
constexpr double kLow = 0.1;

/// Rows, evenly.
std::vector<stored::Row> drawn_rows(stored::Row first, stored::Row end) {
  const std::size_t all = end - first, count = std::min(all, kAsked);
  std::vector<stored::Row> rows;
  for (std::size_t i = 0; i < count; ++i)
    rows.push_back(first + static_cast<stored::Row>((2 * i + 1) * all / (2 * count)));
  return rows;
}

}  // namespace

Likeness likeness_between_clips(const SearchBase& base) {
  const stored::PatchTable& table = base.table;
  Likeness likeness;
  std::vector<double> all;
  for (std::size_t clip = 0; clip < table.clips.size(); ++clip) {
    const stored::Row first = table.first_row[clip], end = table.first_row[clip + 1];
    std::vector<PieceQuery> queries;
    for (const stored::Row row : drawn_rows(first, end)) {
      queries.push_back({.words = table.words[row]});
      queries.back().mask.fill(1);
    }
    RowFilter others(table.size());
    for (stored::Row row = first; row < end; ++row) others.forbid(row);
    double sum = 0;
    std::size_t answered = 0;
    if (!queries.empty() && others.count() > 0)
      for (const std::vector<ScoredPatch>& best : base.index->search(queries, 1, {.rows = &others})) {
        if (best.empty()) continue;
        const double like = static_cast<double>(best.front().score) / max_score(queries.front());
        sum += like;
        ++answered;
        all.push_back(like);
      }
    likeness.clips.push_back(answered > 0 ? sum / static_cast<double>(answered) : -1);
  }
  if (all.empty()) return likeness;
  const auto low = all.begin() + static_cast<std::ptrdiff_t>(kLow * static_cast<double>(all.size()));
  std::nth_element(all.begin(), low, all.end());
  likeness.unlike = *low;
  return likeness;
}

double unlike_share(const Candidates& candidates, double unlike) {
  std::size_t count = 0;
  for (std::size_t piece = 0; piece < candidates.pieces(); ++piece)
    count += candidates.scores_of(piece).front() < unlike;
  return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, candidates.pieces()));
}

}  // namespace freshet::query
