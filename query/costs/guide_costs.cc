#include "query/costs/guide_costs.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace freshet::query {

GuideCosts weighted(const GuideCosts& costs, double weight) {
  const auto& [direction, speed, unsteady] = costs;
  return {.direction = weight * direction, .speed = weight * speed, .unsteady = weight * unsteady};
}

GuideCosts default_guide_costs(HintSearch search) {
  if (search == HintSearch::kNarrow) return {.direction = 0.3, .speed = 0.05, .unsteady = 0};
  return {};
}

double guide_price(const PieceMotion& asked, float mean_u, float mean_v, float steadiness,
                   const GuideCosts& weights) {
  const double u = mean_u, v = mean_v, speed = std::hypot(u, v);
  double price = 0;
  if (asked.direction != cv::Vec2f(0, 0)) {
    if (speed > 0)
      price += weights.direction * (1 - (u * asked.direction[0] + v * asked.direction[1]) / speed);
    price += weights.unsteady * (1 - steadiness);
  }
  if (asked.speed >= 0) {
    // A tenth of a pixel per second is as slow as can be told.
    const double ratio = std::log2(std::max(speed, 0.1) / std::max<double>(asked.speed, 0.1));
    price += weights.speed * ratio * ratio;
  }
  return price;
}

namespace {

/// Of each candidate of a piece.
std::vector<double> guide_prices(const stored::PatchTable& table, const Candidates& candidates,
                                 std::size_t piece, const PieceMotion& asked, const GuideCosts& weights) {
  const auto rows = candidates.rows_of(piece);
  const auto steadiness = candidates.steadiness_of(piece);
  std::vector<double> prices(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    prices[i] = guide_price(asked, table.mean_u[rows[i]], table.mean_v[rows[i]],
                            steadiness.empty() ? 1 : steadiness[i], weights);
  return prices;
}

}  // namespace

void add_guide_costs(const stored::PatchTable& table, const Candidates& candidates, const GuideCosts& weights,
                     Mrf& mrf) {
  for (std::size_t piece = 0; piece < candidates.asked.size(); ++piece) {
    float* const unary = mrf.unary.data() + mrf.first_unary[piece];
    const std::vector<double> prices =
        guide_prices(table, candidates, piece, candidates.asked[piece], weights);
    for (std::size_t i = 0; i < prices.size(); ++i) unary[i] += static_cast<float>(prices[i]);
  }
}

void keep_best_paid(const stored::PatchTable& table, const GuideCosts& weights, std::size_t keep,
                    Candidates& candidates) {
  if (candidates.asked.empty()) return;
  Candidates kept = candidates;
  kept.k = std::min(keep, candidates.k);
  const std::size_t pieces = candidates.pieces();
  kept.rows.assign(pieces * kept.k, stored::kNoRow);
  kept.scores.assign(pieces * kept.k, 0);
  kept.steadiness.assign(candidates.steadiness.empty() ? 0 : pieces * kept.k, 0);
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const auto rows = candidates.rows_of(piece);
    const auto scores = candidates.scores_of(piece), steadiness = candidates.steadiness_of(piece);
    const std::vector<double> prices =
        guide_prices(table, candidates, piece, in_steps(candidates.asked[piece]), weights);
    std::vector<std::size_t> order(rows.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return scores[a] - prices[a] > scores[b] - prices[b];
    });
    order.resize(std::min(order.size(), kept.k));
    for (std::size_t i = 0; i < order.size(); ++i) {
      kept.rows[piece * kept.k + i] = rows[order[i]];
      kept.scores[piece * kept.k + i] = scores[order[i]];
      if (!steadiness.empty()) kept.steadiness[piece * kept.k + i] = steadiness[order[i]];
    }
    kept.counts[piece] = static_cast<std::uint32_t>(order.size());
  }
  candidates = std::move(kept);
}

}  // namespace freshet::query
