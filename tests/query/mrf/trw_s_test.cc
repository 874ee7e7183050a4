#include "query/mrf/trw_s.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include "query/mrf/min_sum.h"
#include "query/mrf/minimizer.h"
#include "tests/query/mrf/random_mrf.h"

namespace freshet::query {
namespace {

TEST(MinSum, AgreesWithThePlainLoopsForEveryShape) {
  std::mt19937_64 random(3);
  std::normal_distribution<float> normal;
  for (std::size_t rows : {1u, 2u, 5u, 16u, 37u}) {
    for (std::size_t columns : {1u, 3u, 4u, 17u, 50u}) {
      std::vector<float> a(rows), b(columns), over_rows(columns), over_columns(rows);
      std::vector<PairCost> table(rows * columns);
      for (PairCost& cost : table) cost = std::abs(normal(random));
      for (auto* values : {&a, &b}) {
        for (float& value : *values) value = normal(random);
      }
      min_over_rows(table.data(), rows, columns, a.data(), over_rows.data());
      min_over_columns(table.data(), rows, columns, b.data(), over_columns.data());
      for (std::size_t j = 0; j < columns; ++j) {
        float minimum = table[j] + a[0];
        for (std::size_t i = 1; i < rows; ++i) minimum = std::min(minimum, table[i * columns + j] + a[i]);
        EXPECT_EQ(over_rows[j], minimum);
      }
      for (std::size_t i = 0; i < rows; ++i) {
        float minimum = table[i * columns] + b[0];
        for (std::size_t j = 1; j < columns; ++j) minimum = std::min(minimum, table[i * columns + j] + b[j]);
        EXPECT_EQ(over_columns[i], minimum);
      }
    }
  }
}

TEST(PairCost, IsTheNearestOfItsStepsAndBoundedAtBothEnds) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<float> exponent(-60, 64);
  for (int i = 0; i < 20000; ++i) {
    const float cost = std::exp2(exponent(random));
    const float kept = PairCost(cost);
    EXPECT_LE(std::abs(kept - cost), cost * 0x1p-10f) << cost;
    EXPECT_EQ(PairCost(kept), PairCost(cost));
  }
  for (const float exact : {0.0f, 0x1p-62f, 0.25f, 1.0f, 1 + 0x1p-9f, 511.0f, 0x1.ff8p64f})
    EXPECT_EQ(float{PairCost(exact)}, exact);
  EXPECT_EQ(float{PairCost(1e-30f)}, 0);
  EXPECT_EQ(float{PairCost(1e30f)}, 0x1.ff8p64f);
  EXPECT_LT(float{PairCost(0.7f)}, float{PairCost(0.702f)});
}

TEST(TrwS, IsExactOnTrees) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Mrf mrf =
        random_mrf({.width = 3, .height = 3, .uneven_labels = seed % 2 == 0, .tree = true, .seed = seed});
    const Solution solution = trw_s(mrf, {.gap = 0});
    const double minimum = exhaustive_minimum(mrf);
    EXPECT_NEAR(solution.energy, minimum, 1e-4) << seed;
    EXPECT_NEAR(solution.lower_bound, minimum, 1e-4) << seed;
  }
}

TEST(TrwS, BoundsTheMinimumFromBelowAndAbove) {
  int exact = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Mrf mrf = random_mrf({.uneven_labels = seed % 2 == 0, .seed = seed});
    const Solution solution = trw_s(mrf, {.gap = 0});
    const double minimum = exhaustive_minimum(mrf);
    EXPECT_LE(solution.lower_bound, minimum + 1e-4) << seed;
    EXPECT_GE(solution.energy, minimum - 1e-4) << seed;
    EXPECT_NEAR(solution.energy, energy(mrf, solution.labels), 1e-9);
    EXPECT_GT(solution.lower_bound, 0.8 * minimum) << seed;
    exact += solution.energy < minimum + 1e-4;
  }
  EXPECT_GE(exact, 30);
}

TEST(TrwS, TakesTheBestUnaryLabelsWithoutEdges) {
  Mrf mrf;
  mrf.add_node(std::vector<float>{3, 1, 2});
  mrf.add_node(std::vector<float>{-1, 5});
  const Solution solution = trw_s(mrf);
  EXPECT_EQ(solution.labels, (Labels{1, 0}));
  EXPECT_EQ(solution.energy, 0);
  EXPECT_EQ(solution.lower_bound, 0);
  EXPECT_TRUE(trw_s(Mrf{}).labels.empty());
}

TEST(TrwS, TakesTheOnlyLabelThereIs) {
  const Mrf mrf = random_mrf({.labels = 1});
  const Solution solution = trw_s(mrf);
  EXPECT_EQ(solution.labels, Labels(mrf.nodes(), 0));
  EXPECT_NEAR(solution.lower_bound, solution.energy, 1e-4);
}

TEST(TrwS, EndsAtTheGapThatIsAsked) {
  const Mrf mrf = picture_sized_mrf(1, 12, 10, 40);
  const Solution whole = trw_s(mrf, {.gap = 0}), some = trw_s(mrf, {.gap = 0.05});
  EXPECT_LT(some.iterations, whole.iterations);
  EXPECT_LE(some.energy - some.lower_bound, 0.05 * some.lower_bound);
  EXPECT_GE(some.energy, whole.lower_bound);
}

TEST(TrwS, IsTheSameForAnyNumberOfThreads) {
  const Mrf mrf = picture_sized_mrf(2, 24, 20, 40);
  Solution reference;
  for (const int threads : {1, 2, 8, 8, 8}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
    oneapi::tbb::task_arena arena(threads);
    const Solution solution = arena.execute([&] { return trw_s(mrf, {.max_iterations = 20, .gap = 0}); });
    if (threads == 1) reference = solution;
    EXPECT_EQ(solution, reference) << threads;
  }
}

/// A field whose numbers are the same wherever there is the standard's generator: multiples of 2^-16, of no
/// distribution of the library's.
Mrf portable_mrf(std::uint64_t seed) {
  constexpr std::uint32_t kWidth = 12, kHeight = 9;
  std::mt19937_64 random(seed);
  const auto cost = [&] { return static_cast<float>(random() >> 48) / 0x1p16f; };
  Mrf mrf;
  std::vector<float> costs;
  for (std::uint32_t node = 0; node < kWidth * kHeight; ++node) {
    costs.resize(5 + random() % 20);
    for (float& value : costs) value = cost();
    mrf.add_node(costs);
  }
  for (std::uint32_t node = 0; node < kWidth * kHeight; ++node)
    for (const bool down : {false, true}) {
      if (down ? node / kWidth + 1 == kHeight : node % kWidth + 1 == kWidth) continue;
      const std::uint32_t other = node + (down ? kWidth : 1);
      const Mrf::Edge edge = mrf.edges[mrf.add_edge(node, other)];
      const std::size_t size = std::size_t{mrf.label_count[node]} * mrf.label_count[other];
      for (std::size_t i = 0; i < size; ++i) {
        const float value = cost();
        mrf.table(edge)[i] = value * value;
      }
    }
  return mrf;
}

std::uint64_t hash_of(const Labels& labels) {  // FNV-1a
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const auto label : labels) hash = (hash ^ label) * 0x100000001b3ULL;
  return hash;
}

// Labels depend on sums of floats, whose order is written in the loops: they are the same on every machine.
TEST(TrwS, GivesTheLabelsThatItGaveOnOtherMachines) {
  const Mrf mrf = portable_mrf(11);
  EXPECT_EQ(hash_of(trw_s(mrf, {.max_iterations = 30, .gap = 0}).labels), 0x0e06cdef67ed514eULL);
  EXPECT_EQ(hash_of(minimize(mrf, Minimizer::kTrwS).labels), 0xd3d19d3e95d29d1fULL);
  EXPECT_EQ(hash_of(minimize(mrf, Minimizer::kAlphaExpansion).labels), 0x953a5025a3b054cfULL);
}

TEST(Minimizer, StopsAfterAsManyIterationsAsItIsGiven) {
  const Mrf mrf = picture_sized_mrf(1, 12, 10, 40);
  for (const Minimizer minimizer : {Minimizer::kTrwS, Minimizer::kAlphaExpansion, Minimizer::kIcm}) {
    EXPECT_EQ(minimize(mrf, minimizer, 1).iterations, 1) << name_of(minimizer);
    EXPECT_GT(minimize(mrf, minimizer).iterations, 1) << name_of(minimizer);
  }
}

TEST(Minimizer, TrwSThenForestsComesWithinThreePerCentOfTheBoundOnAPicture) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Mrf mrf = picture_sized_mrf(seed, 12, 10, 40);
    const Solution solution = minimize(mrf, Minimizer::kTrwS);
    EXPECT_LE(solution.lower_bound, solution.energy);
    EXPECT_LT(solution.energy, 1.03 * solution.lower_bound);
    for (const Minimizer other : {Minimizer::kAlphaExpansion, Minimizer::kIcm}) {
      EXPECT_LE(solution.energy, minimize(mrf, other).energy) << name_of(other);
      EXPECT_GE(minimize(mrf, other).energy, solution.lower_bound) << name_of(other);
    }
    EXPECT_EQ(minimize(mrf, Minimizer::kTrwS), solution);
  }
}

}  // namespace
}  // namespace freshet::query
