#include "tests/query/costs/made_tables.h"

#include "tests/query/search/made_field.h"

namespace freshet::query {
namespace {

Target lattice(int columns, int rows) {
  Target target;
  target.columns = columns;
  target.rows = rows;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const auto piece = static_cast<std::uint32_t>(y * columns + x);
      target.places.emplace_back(x, y);
      target.corners.emplace_back(x * target.stride, y * target.stride);
      if (x > 0) target.edges.emplace_back(piece - 1, piece);
      if (y > 0) target.edges.emplace_back(piece - static_cast<std::uint32_t>(columns), piece);
    }
  }
  return target;
}

}  // namespace

std::vector<float> made_tables(bool power) {
  const Target target = lattice(5, 4);
  const Candidates candidates = some_candidates(target.size(), 23);
  const FeatureShape shape;
  const Mrf mrf = build_mrf(target, candidates, shape,
                            default_costs(power ? CostForm::kPower : CostForm::kLog), source_of(shape));
  std::vector<float> costs(mrf.unary.begin(), mrf.unary.end());
  costs.insert(costs.end(), mrf.pairwise.begin(), mrf.pairwise.end());
  return costs;
}

}  // namespace freshet::query
