#include "query/search/coherent_candidates.h"

#include <algorithm>
#include <tuple>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "vision/spatial_pyramid.h"

namespace freshet::query {

stored::Row find_patch(const stored::PatchTable& table, std::uint32_t clip, std::uint8_t variant, int x,
                       int y) {
  // A clip's rows are sorted by variant and, within it, row-major.
  stored::Row low = table.first_row[clip], high = table.first_row[clip + 1];
  const auto wanted = std::tuple(static_cast<int>(variant), y, x);
  const auto at = [&](stored::Row row) {
    return std::tuple(static_cast<int>(table.variant[row]), static_cast<int>(table.y[row]),
                      static_cast<int>(table.x[row]));
  };
  while (low < high) {
    const stored::Row middle = low + (high - low) / 2;
    if (at(middle) < wanted)
      low = middle + 1;
    else
      high = middle;
  }
  return low < table.first_row[clip + 1] && at(low) == wanted ? low : stored::kNoRow;
}

void add_coherent(const stored::PatchTable& table, int word_count, const Target& target,
                  const RowFilter& filter, const MotionGuide& guide, std::size_t each,
                  Candidates& candidates) {
  if (each == 0 || target.edges.empty()) return;
  const std::size_t pieces = target.size();
  std::vector<std::vector<std::uint32_t>> neighbours(pieces);
  for (const auto& [p, q] : target.edges) {
    neighbours[p].push_back(q);
    neighbours[q].push_back(p);
  }
  const std::size_t k = candidates.k + 4 * each;
  std::vector<std::vector<ScoredPatch>> lists(pieces);  // scores as intersections
  oneapi::tbb::parallel_for(std::size_t{0}, pieces, [&](std::size_t piece) {
    const PieceQuery& query = target.queries[piece];
    const MotionWindow window = candidates.asked.empty()
                                    ? MotionWindow{}
                                    : window_of(candidates.asked[piece], guide, candidates.opened[piece]);
    const auto own = candidates.rows_of(piece);
    std::vector<stored::Row> known(own.begin(), own.end());
    std::sort(known.begin(), known.end());
    for (const std::uint32_t neighbour : neighbours[piece]) {
      const cv::Point step = (target.places[piece] - target.places[neighbour]) * target.stride;
      const auto theirs = candidates.rows_of(neighbour);
      for (std::size_t i = 0; i < std::min(each, theirs.size()); ++i) {
        const stored::Row from = theirs[i];
        const stored::Row row = find_patch(table, table.clip[from], table.variant[from],
                                           table.x[from] + step.x, table.y[from] + step.y);
        if (row == stored::kNoRow || !filter.allows(row)) continue;
        if (!window.is_any() && !window.admits(table.mean_u[row], table.mean_v[row])) continue;
        const auto place = std::lower_bound(known.begin(), known.end(), row);
        if (place != known.end() && *place == row) continue;
        known.insert(place, row);
        const int score = vision::intersection(query.words, table.words[row], word_count, &query.mask);
        lists[piece].push_back({row, static_cast<std::uint32_t>(score)});
      }
    }
  });

  Candidates joined = candidates;
  joined.k = k;
  joined.rows.assign(pieces * k, stored::kNoRow);
  joined.scores.assign(pieces * k, 0);
  joined.steadiness.clear();
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const auto full = static_cast<float>(max_score(target.queries[piece]));
    std::vector<std::pair<float, stored::Row>> all;
    for (std::size_t i = 0; i < candidates.counts[piece]; ++i)
      all.emplace_back(candidates.scores_of(piece)[i], candidates.rows_of(piece)[i]);
    for (const ScoredPatch& scored : lists[piece])
      all.emplace_back(static_cast<float>(scored.score) / full, scored.row);
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    for (std::size_t i = 0; i < all.size(); ++i) {
      joined.scores[piece * k + i] = all[i].first;
      joined.rows[piece * k + i] = all[i].second;
    }
    joined.counts[piece] = static_cast<std::uint32_t>(all.size());
  }
  candidates = std::move(joined);
}

}  // namespace freshet::query
