#include "bench/labelling/fusion_moves.h"

#include <gtest/gtest.h>

#include "tests/query/mrf/random_mrf.h"

namespace freshet::bench {
namespace {

using query::Labels;
using query::Mrf;
using Choice = Fusion::Choice;

struct Best {
  double energy = 0, agreeing = 0;  // of all mixtures, and of those that agree with the choices
};

// Every mixture of the two labellings.
Best best_mixture(const Mrf& mrf, const Labels& labels, const Labels& proposal,
                  std::span<const Choice> choices) {
  Best best{1e30, 1e30};
  for (std::uint32_t takes = 0; takes < 1u << mrf.nodes(); ++takes) {
    Labels mixed = labels;
    bool agrees = true;
    for (std::size_t node = 0; node < mrf.nodes(); ++node) {
      const bool take = takes >> node & 1;
      if (take) mixed[node] = proposal[node];
      agrees = agrees && choices[node] != (take ? Choice::kKeep : Choice::kTake);
    }
    const double found = energy(mrf, mixed);
    best.energy = std::min(best.energy, found);
    if (agrees) best.agreeing = std::min(best.agreeing, found);
  }
  return best;
}

TEST(Fusion, ABestMixtureAgreesWithAllThatIsChosen) {
  std::size_t chosen = 0, open = 0, taken = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Mrf mrf = query::random_mrf({.width = 4, .height = 3, .labels = 2, .seed = seed});
    const Labels labels(mrf.nodes(), seed % 2), proposal(mrf.nodes(), 1 - seed % 2);
    Fusion fusion(mrf);
    const auto choices = fusion.choose(labels, proposal);
    const Best best = best_mixture(mrf, labels, proposal, choices);
    EXPECT_NEAR(best.agreeing, best.energy, 1e-6) << seed;
    Labels kept = labels;
    for (std::size_t node = 0; node < kept.size(); ++node) {
      if (choices[node] == Choice::kTake) kept[node] = proposal[node];
      chosen += choices[node] != Choice::kOpen;
      open += choices[node] == Choice::kOpen;
      taken += choices[node] == Choice::kTake;
    }
    EXPECT_LE(energy(mrf, kept), energy(mrf, labels) + 1e-6) << seed;
  }
  EXPECT_GT(chosen, open);
  EXPECT_GT(open, 0U);
  EXPECT_GT(taken, 100U);
}

TEST(Fusion, LeavesNothingOpenWhenTermsAreSubmodular) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Mrf mrf =
        query::random_mrf({.width = 4, .height = 3, .labels = 2, .submodular = true, .seed = seed});
    query::Solution solution;
    solution.labels = Labels(mrf.nodes(), 0);
    solution.energy = energy(mrf, solution.labels);
    fusion_moves(mrf, solution);
    EXPECT_NEAR(solution.energy, exhaustive_minimum(mrf), 1e-4) << seed;
  }
}

TEST(FusionMoves, NeverRaiseTheEnergyAndSayWhatItIs) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Mrf mrf = query::random_mrf({.labels = 4, .uneven_labels = seed % 2 == 0, .seed = seed});
    query::Solution solution;
    solution.labels = unary_minimum(mrf);
    solution.energy = energy(mrf, solution.labels);
    const double start = solution.energy;
    fusion_moves(mrf, solution);
    EXPECT_LE(solution.energy, start);
    EXPECT_NEAR(solution.energy, energy(mrf, solution.labels), 1e-9);
    EXPECT_GE(solution.energy, exhaustive_minimum(mrf) - 1e-6);
  }
}

}  // namespace
}  // namespace freshet::bench
