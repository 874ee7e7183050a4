#include "query/pairwise.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <set>

#include "freshet_error.h"
#include "made_field.h"
#include "query/squared_distances.h"

namespace freshet::query {
namespace {

// Eq. 2, 3 and 6, cell by cell, in double precision.
double naive_cost(const FeatureShape& shape, const PairwiseOptions& options, Row a, Row b, bool beside) {
  const auto of_a = features_of(a, shape), of_b = features_of(b, shape);
  const int first = shape.cells - shape.overlap;
  double sum = 0;
  for (int y = 0; y < (beside ? shape.cells : shape.overlap); ++y) {
    for (int x = 0; x < (beside ? shape.overlap : shape.cells); ++x) {
      const int cell_a = (y + (beside ? 0 : first)) * shape.cells + x + (beside ? first : 0);
      const int cell_b = y * shape.cells + x;
      const float* p = of_a.data() + static_cast<std::ptrdiff_t>(cell_a) * shape.channels();
      const float* q = of_b.data() + static_cast<std::ptrdiff_t>(cell_b) * shape.channels();
      double motion = 0, power = 0, texture = 0;
      const auto square = [](double value) { return value * value; };
      const bool raw = options.form == CostForm::kPower;
      const auto shrink = [&](const float* cell) {
        const double speed = std::hypot(double{cell[0]}, double{cell[1]});
        return raw ? 1.0 / 25 : std::log1p(speed / 2.5) / speed;
      };
      for (int c = 0; c < 2; ++c) motion += square(p[c] * shrink(p) - q[c] * shrink(q));
      for (int c = 2; c < 2 + 2 * shape.bands; ++c) {
        power += raw ? square((double{p[c]} - q[c]) / 625)
                     : square(0.5 * std::log1p(double{p[c]}) - 0.5 * std::log1p(double{q[c]}));
      }
      for (int c = 2 + 2 * shape.bands; c < shape.channels(); ++c) {
        texture += raw ? square(double{p[c]} - q[c])
                       : square(std::log1p(double{p[c]} * 512) - std::log1p(double{q[c]} * 512));
      }
      sum += motion + options.sigma * power + options.rho * texture;
    }
  }
  return options.lambda * sum / (shape.cells * shape.overlap);
}

// How strongly a patch moves, in double precision: its cost beside a patch that stands still, textureness
// aside, as a mean over all of its cells.
double naive_strength(const FeatureShape& shape, const PairwiseOptions& options, Row row) {
  const auto features = features_of(row, shape);
  double sum = 0;
  for (std::size_t at = 0; at < features.size(); at += static_cast<std::size_t>(shape.channels())) {
    const float* cell = features.data() + at;
    const double speed = std::hypot(double{cell[0]}, double{cell[1]});
    sum += std::pow(std::log1p(speed / 2.5), 2);
    for (int c = 2; c < 2 + 2 * shape.bands; ++c)
      sum += options.sigma * std::pow(0.5 * std::log1p(double{cell[c]}), 2);
  }
  return std::sqrt(options.lambda * sum / (shape.cells * shape.cells));
}

TEST(Pairwise, CandidatesVoteOnHowStronglyAPieceMoves) {
  const Target target = some_target();
  const Candidates candidates = some_candidates(target.size(), 13);
  const FeatureShape shape;
  const PairwiseOptions options{.vote = 3};
  const Mrf mrf = build_mrf(target, candidates, shape, options, source_of(shape));
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    std::vector<double> strengths;
    for (const Row row : candidates.rows_of(piece)) strengths.push_back(naive_strength(shape, options, row));
    std::vector<double> sorted = strengths;
    std::sort(sorted.begin(), sorted.end());
    const double median = sorted[sorted.size() / 2];
    for (std::size_t i = 0; i < strengths.size(); ++i) {
      const double expected = 1 - candidates.scores_of(piece)[i] + 3 * std::pow(strengths[i] - median, 2);
      EXPECT_NEAR(mrf.unary_of(piece)[i], expected, 1e-4 * expected + 1e-6);
    }
  }
}

TEST(Pairwise, AgreesWithTheObviousLoops) {
  const Target target = some_target();
  const Candidates candidates = some_candidates(target.size(), 13);
  const FeatureShape shape;
  for (const CostForm form : {CostForm::kLog, CostForm::kPower}) {
    const PairwiseOptions options = default_costs(form);
    const Mrf mrf = build_mrf(target, candidates, shape, options, source_of(shape));
    ASSERT_EQ(mrf.nodes(), target.size());
    ASSERT_EQ(mrf.edges.size(), target.edges.size());
    for (std::size_t e = 0; e < mrf.edges.size(); ++e) {
      const Mrf::Edge& edge = mrf.edges[e];
      ASSERT_EQ(std::pair(edge.p, edge.q), target.edges[e]);
      const bool beside = target.places[edge.p].y == target.places[edge.q].y;
      const auto rows_p = candidates.rows_of(edge.p), rows_q = candidates.rows_of(edge.q);
      for (std::size_t i = 0; i < rows_p.size(); ++i) {
        for (std::size_t j = 0; j < rows_q.size(); j += 3) {
          const double expected = naive_cost(shape, options, rows_p[i], rows_q[j], beside);
          EXPECT_NEAR(mrf.table(edge)[i * rows_q.size() + j], expected, 1e-4 * expected + 1e-9)
              << name_of(form);
        }
      }
    }
    if (options.vote > 0) continue;
    for (std::size_t piece = 0; piece < target.size(); ++piece) {
      EXPECT_FLOAT_EQ(mrf.unary_of(piece)[0], 1 - candidates.scores_of(piece)[0]);
    }
  }
}

TEST(Pairwise, IsTheSameForAnyNumberOfThreads) {
  const Target target = some_target();
  const Candidates candidates = some_candidates(target.size(), 21);
  const FeatureShape shape;
  std::vector<float> reference;
  for (const int threads : {1, 2, 8}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    const Mrf mrf = build_mrf(target, candidates, shape, {}, source_of(shape));
    if (reference.empty()) reference = mrf.pairwise;
    EXPECT_EQ(mrf.pairwise, reference);
  }
}

TEST(Pairwise, ReadsEachPatchOnceARowOfPieces) {
  const Target target = some_target();
  const Candidates candidates = some_candidates(target.size(), 40);
  const FeatureShape shape;
  std::vector<std::set<Row>> wanted(target.rows);
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    for (const Row row : candidates.rows_of(piece)) wanted[target.places[piece].y].insert(row);
  }
  FeatureSource source = source_of(shape);
  std::size_t bands = 0;
  source.prepare = [&](std::span<const Row> rows) { EXPECT_TRUE(std::ranges::equal(rows, wanted[bands++])); };
  std::atomic<std::size_t> reads = 0;
  source.read = [&, read = source.read](Row row, std::span<float> out) {
    ++reads;
    read(row, out);
  };
  build_mrf(target, candidates, shape, {}, source);
  std::size_t distinct = 0;
  for (const auto& rows : wanted) distinct += rows.size();
  EXPECT_EQ(bands, wanted.size());
  EXPECT_EQ(reads, distinct);
}

TEST(Pairwise, RefusesWeightsThatAreNone) {
  const Target target = some_target();
  const Candidates candidates = some_candidates(target.size(), 2);
  const FeatureShape shape;
  for (const double bad : {-1.0, std::nan(""), HUGE_VAL}) {
    PairwiseOptions options;
    options.sigma = bad;
    EXPECT_THROW(build_mrf(target, candidates, shape, options, source_of(shape)), Error);
  }
}

TEST(SquaredDistances, ReachesEveryPairOfEveryShape) {
  std::mt19937_64 random(6);
  std::normal_distribution<float> normal;
  for (const std::size_t count_a : {1u, 4u, 7u, 9u, 17u}) {
    for (const std::size_t count_b : {1u, 8u, 13u}) {
      const std::size_t length = 37;
      std::vector<std::vector<float>> a(count_a, std::vector<float>(length)), b(count_b, a[0]);
      Panel panel_a, panel_b;
      panel_a.resize(count_a, length);
      panel_b.resize(count_b, length);
      for (const auto& [vectors, panel] : {std::pair{&a, &panel_a}, std::pair{&b, &panel_b}}) {
        for (std::size_t i = 0; i < vectors->size(); ++i) {
          for (float& value : (*vectors)[i]) value = normal(random);
          panel->set(i, 0, std::span((*vectors)[i]).first(20));
          panel->set(i, 20, std::span((*vectors)[i]).subspan(20));
        }
      }
      std::vector<float> found(count_a * count_b, -1);
      squared_distances(panel_a, panel_b, found);
      for (std::size_t i = 0; i < count_a; ++i) {
        for (std::size_t j = 0; j < count_b; ++j) {
          double expected = 0;
          for (std::size_t d = 0; d < length; ++d) expected += std::pow(double{a[i][d]} - b[j][d], 2);
          EXPECT_NEAR(found[i * count_b + j], expected, 1e-5 * expected);
        }
      }
    }
  }
}

}  // namespace
}  // namespace freshet::query
