#include "query/mrf/icm.h"

#include <algorithm>

namespace freshet::query {

Solution icm(const Mrf& mrf, const IcmOptions& options) {
  const Adjacency adjacency(mrf);
  Solution solution;
  solution.labels = unary_minimum(mrf);
  std::vector<float> costs;
  bool changed = true;
  while (changed && solution.iterations < options.max_sweeps) {
    changed = false;
    ++solution.iterations;
    for (std::size_t node = 0; node < mrf.nodes(); ++node) {
      const auto unary = mrf.unary_of(node);
      costs.assign(unary.begin(), unary.end());
      add_neighbour_costs(mrf, adjacency, node, solution.labels, costs);
      const auto best = std::min_element(costs.begin(), costs.end());
      if (*best < costs[solution.labels[node]]) {
        solution.labels[node] = static_cast<std::uint32_t>(best - costs.begin());
        changed = true;
      }
    }
  }
  solution.energy = energy(mrf, solution.labels);
  return solution;
}

}  // namespace freshet::query
