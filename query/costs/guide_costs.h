// query/costs/guide_costs.h — what it costs a candidate not to move as a guide asks.
#pragma once

#include <cstddef>

#include "query/mrf/mrf.h"
#include "query/search/candidates.h"
#include "query/search/motion_guide.h"
#include "stored/patch_table.h"

namespace freshet::query {

/// What it costs a candidate not to move quite as asked. Pieces of which nothing is asked pay nothing. Added to
/// the unary costs, which are 1 - score:
///   direction * (1 - cos of the angle) + speed * (log2 of the ratio)^2 + unsteady * (1 - steadiness)
/// the last where a direction is asked.
///
/// Where the search is narrow, patches move about as asked already, and are shown as they are: what is left costs
/// much. Where it is wide the animation turns and scales them, and looks decide: over 23 clips and their true
/// motion a candidate is 0.313 alike where nothing else counts, 0.299 with these prices, 31 degrees and 1.2
/// octaves off, and 0.217 when narrow (docs/measurements/labelling.md).
struct GuideCosts {
  double direction = 0.05, speed = 0.01, unsteady = 0.05;
};
GuideCosts default_guide_costs(HintSearch search);
/// Each of them times a weight.
GuideCosts weighted(const GuideCosts& costs, double weight);
/// steadiness   0..1, see steadiness.h; 1 where it is not known.
double guide_price(const PieceMotion& asked, float mean_u, float mean_v, float steadiness,
                   const GuideCosts& weights);
void add_guide_costs(const stored::PatchTable& table, const Candidates& candidates, const GuideCosts& weights,
                     Mrf& mrf);

/// Sorts each piece's candidates by score less the price of what is asked in_steps, and keeps the first `keep`.
void keep_best_paid(const stored::PatchTable& table, const GuideCosts& weights, std::size_t keep,
                    Candidates& candidates);

}  // namespace freshet::query
