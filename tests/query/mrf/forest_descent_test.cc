#include "query/mrf/forest_descent.h"

#include <gtest/gtest.h>

#include "query/mrf/icm.h"
#include "tests/query/mrf/random_mrf.h"

namespace freshet::query {
namespace {

Solution start(const Mrf& mrf) {
  Solution solution;
  solution.labels.assign(mrf.nodes(), 0);
  solution.energy = energy(mrf, solution.labels);
  return solution;
}

TEST(ForestDescent, IsExactOnTreesFromAnyStart) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Mrf mrf = random_mrf({.uneven_labels = seed % 2 == 0, .tree = true, .seed = seed});
    Solution solution = start(mrf);
    forest_descent(mrf, solution);
    EXPECT_NEAR(solution.energy, exhaustive_minimum(mrf), 1e-4) << seed;
  }
}

TEST(ForestDescent, LeavesNothingForSingleNodesToGain) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Mrf mrf = random_mrf({.width = 7, .height = 6, .labels = 5, .seed = seed});
    Solution solution = start(mrf);
    forest_descent(mrf, solution);
    EXPECT_NEAR(solution.energy, energy(mrf, solution.labels), 1e-9);
    for (std::size_t node = 0; node < mrf.nodes(); ++node) {
      for (std::uint32_t label = 0; label < mrf.label_count[node]; ++label) {
        Labels labels = solution.labels;
        labels[node] = label;
        EXPECT_GE(energy(mrf, labels), solution.energy - 1e-5);
      }
    }
  }
}

TEST(ForestDescent, NeverRaisesTheEnergyAndRepeatsItself) {
  const Mrf mrf = picture_sized_mrf(5, 10, 8, 20);
  Solution once = icm(mrf);
  const double before = once.energy;
  Solution twice = once;
  forest_descent(mrf, once);
  forest_descent(mrf, twice);
  EXPECT_LT(once.energy, before);
  EXPECT_EQ(once, twice);
}

TEST(ForestDescent, AcceptsAFieldWithoutNodesOrEdges) {
  Mrf mrf;
  Solution solution;
  forest_descent(mrf, solution);
  EXPECT_TRUE(solution.labels.empty());
  mrf.add_node(std::vector<float>{2, 1});
  solution = start(mrf);
  forest_descent(mrf, solution);
  EXPECT_EQ(solution.labels, Labels{1});
}

}  // namespace
}  // namespace freshet::query
