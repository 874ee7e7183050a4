#include "query/mrf/spread.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

namespace freshet::query {
namespace {

constexpr int kRounds = 4;
constexpr std::size_t kFewNodes = 20;  // may well be of one group

}  // namespace

Solution minimize_spread(std::span<const std::uint32_t> groups, double price, Minimizer minimizer,
                         int max_iterations, Mrf& mrf) {
  assert(groups.size() == mrf.unary.size());
  Solution solution = minimize(mrf, minimizer, max_iterations);
  const std::size_t nodes = mrf.nodes();
  if (price <= 0 || nodes < kFewNodes) return solution;
  const Solution first = solution;
  const std::vector<float> unpriced = mrf.unary;
  const std::uint32_t last_group = *std::max_element(groups.begin(), groups.end());
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::size_t> uses(std::size_t{last_group} + 1, 0);
    for (std::size_t node = 0; node < nodes; ++node)
      ++uses[groups[mrf.first_unary[node] + solution.labels[node]]];
    const auto max = std::max_element(uses.begin(), uses.end());
    if (2 * *max <= nodes) break;
    const auto crowded = static_cast<std::uint32_t>(max - uses.begin());
    for (std::size_t label = 0; label < groups.size(); ++label)
      if (groups[label] == crowded) mrf.unary[label] += static_cast<float>(price);
    const int before = solution.iterations;
    solution = minimize(mrf, minimizer, max_iterations);
    solution.iterations += before;
  }
  if (solution.labels != first.labels) return solution;
  mrf.unary = unpriced;
  return first;
}

}  // namespace freshet::query
