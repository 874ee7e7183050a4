#include "query/mrf/spread.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace freshet::query {
namespace {

TEST(Spread, LeavesAGroupThatHasMoreThanHalfWhereOthersAreNearlyAsGood) {
  // 30 nodes, each between two groups; the first is the better one by a little, for ten of them by much.
  std::vector<std::uint32_t> groups;
  Mrf mrf;
  for (int node = 0; node < 30; ++node) {
    groups.insert(groups.end(), {0, 1});
    const float worse = node < 10 ? 0.5f : 0.001f * static_cast<float>(node);
    mrf.add_node(std::vector<float>{0, worse});
  }
  const auto of_first = [&](double price, Mrf field) {
    const Solution solution = minimize_spread(groups, price, Minimizer::kTrwS, 20, field);
    EXPECT_NEAR(solution.energy, energy(field, solution.labels), 1e-6) << "of the field with its prices";
    EXPECT_LE(solution.lower_bound, solution.energy + 1e-6);
    return std::count(solution.labels.begin(), solution.labels.end(), 0u);
  };
  EXPECT_EQ(of_first(0, mrf), 30);
  EXPECT_LE(of_first(0.02, mrf), 15);
  EXPECT_GE(of_first(0.02, mrf), 10);
  EXPECT_EQ(of_first(0.001, mrf), 30) << "four rounds at most";
}

}  // namespace
}  // namespace freshet::query
