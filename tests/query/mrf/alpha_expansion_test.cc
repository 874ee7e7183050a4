#include "query/mrf/alpha_expansion.h"

#include <gtest/gtest.h>

#include "query/mrf/icm.h"
#include "tests/query/mrf/random_mrf.h"

namespace freshet::query {
namespace {

TEST(AlphaExpansion, IsExactForTwoLabelsWhenTermsAreSubmodular) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Mrf mrf = random_mrf({.width = 4, .height = 3, .labels = 2, .submodular = true, .seed = seed});
    EXPECT_NEAR(alpha_expansion(mrf).energy, exhaustive_minimum(mrf), 1e-4) << seed;
  }
}

TEST(AlphaExpansion, NeverEndsAboveItsStartWhateverTheTables) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Mrf mrf = random_mrf({.labels = 4, .uneven_labels = seed % 2 == 0, .seed = seed});
    const Solution solution = alpha_expansion(mrf);
    EXPECT_LE(solution.energy, energy(mrf, unary_minimum(mrf)));
    EXPECT_NEAR(solution.energy, energy(mrf, solution.labels), 1e-9);
    EXPECT_EQ(alpha_expansion(mrf), solution);
  }
}

TEST(AlphaExpansion, AcceptsAFieldWithoutEdgesOrWithOneLabel) {
  Mrf mrf;
  mrf.add_node(std::vector<float>{3, 1, 2});
  mrf.add_node(std::vector<float>{4});
  EXPECT_EQ(alpha_expansion(mrf).labels, (Labels{1, 0}));
  EXPECT_TRUE(alpha_expansion(Mrf{}).labels.empty());
}

TEST(Icm, StopsWhereNoSingleNodeGains) {
  const Mrf mrf = random_mrf({.width = 6, .height = 5, .labels = 4, .seed = 9});
  const Solution solution = icm(mrf);
  EXPECT_LT(solution.energy, energy(mrf, unary_minimum(mrf)));
  for (std::size_t node = 0; node < mrf.nodes(); ++node) {
    for (std::uint32_t label = 0; label < mrf.label_count[node]; ++label) {
      Labels labels = solution.labels;
      labels[node] = label;
      EXPECT_GE(energy(mrf, labels), solution.energy - 1e-5);
    }
  }
}

}  // namespace
}  // namespace freshet::query
