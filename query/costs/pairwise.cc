#include "query/costs/pairwise.h"

#include <cassert>
#include <cmath>
#include <numeric>

#include "freshet/error.h"
#include "query/costs/pairwise_parts.h"
#include "vision/patch_features.h"

namespace freshet::query {
namespace {

constexpr double kMaxWeight = 1e9;  // beyond it single precision has no room for the costs

}  // namespace

CostForm parse_cost_form(const std::string& name) {
  for (const CostForm form : {CostForm::kLog, CostForm::kPower}) {
    if (name == name_of(form)) return form;
  }
  throw Error(ErrorKind::kUsage, "cost form \"" + name + "\"", "no such form", "Use log or power");
}

const char* name_of(CostForm form) { return form == CostForm::kLog ? "log" : "power"; }

PairwiseOptions default_costs(CostForm form) {
  PairwiseOptions options;
  if (form == CostForm::kPower) options = {CostForm::kPower, 0.01, 100, 100 * 100, 0};
  return options;
}

int FeatureShape::channels() const { return 2 + 2 * bands + vision::kTextureLevels; }

std::size_t FeatureShape::values() const { return static_cast<std::size_t>(cells) * cells * channels(); }

int FeatureShape::square() const { return overlap > 0 ? std::gcd(cells, overlap) : cells; }

std::size_t FeatureShape::square_values() const {
  return static_cast<std::size_t>(square()) * square() * channels();
}

FeatureShape feature_shape(const vision::Settings& settings) {
  const int cell = settings.spectrum.cell, side = settings.grid.patch, stride = settings.grid.stride;
  if (side % cell != 0 || stride % cell != 0) {
    throw Error(ErrorKind::kUsage, "the store's settings",
                "patches of " + std::to_string(side) + " px every " + std::to_string(stride) +
                    " px do not share whole cells of " + std::to_string(cell) + " px",
                "Make the store again with a stride that is a multiple of the cell");
  }
  FeatureShape shape;
  shape.cells = side / cell;
  shape.bands = vision::motion_bands(settings.spectrum);
  shape.overlap = std::max(0, (side - stride) / cell);
  assert(shape.channels() == vision::feature_channels(settings.spectrum));
  return shape;
}

void check_weights(const PairwiseOptions& options) {
  for (const double weight : {options.lambda, options.sigma, options.rho, options.vote}) {
    if (!(weight >= 0 && weight <= kMaxWeight)) {
      throw Error(ErrorKind::kUsage, "lambda, sigma, rho, vote",
                  "a weight that is negative, no number or above 1e9");
    }
  }
}

Mrf unconnected_field(const Target& target, const Candidates& candidates) {
  assert(candidates.pieces() == target.size());
  Mrf mrf;
  std::vector<float> costs;
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    costs.clear();
    // Eq. 5 prints V = I; Eq. 4 is minimised, and would choose what is least alike.
    for (const float score : candidates.scores_of(piece)) costs.push_back(1 - score);
    mrf.add_node(costs);
  }
  std::size_t pairs = 0;
  for (const auto& [p, q] : target.edges) pairs += std::size_t{mrf.label_count[p]} * mrf.label_count[q];
  mrf.pairwise.reserve(pairs);
  for (const auto& [p, q] : target.edges) mrf.add_edge(p, q);
  return mrf;
}

Mrf build_mrf(const Target& target, const Candidates& candidates, const FeatureShape& shape,
              const PairwiseOptions& options, const FeatureSource& source, std::stop_token stop) {
  check_weights(options);
  Mrf mrf = unconnected_field(target, candidates);
  if (options.lambda == 0) return mrf;
  const PartsSink sink{
      [&](std::uint32_t piece, const PieceParts& parts) {
        add_votes(parts, options, {mrf.unary.data() + mrf.first_unary[piece], mrf.label_count[piece]});
      },
      [&](std::size_t edge, const EdgeParts& parts) {
        weigh(parts, options, {mrf.table(mrf.edges[edge]), parts.motion.size()});
      }};
  visit_parts(target, candidates, shape, options.form, source, {}, sink, stop);
  return mrf;
}

}  // namespace freshet::query
