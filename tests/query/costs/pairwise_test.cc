#include "query/costs/pairwise.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <set>

#include "freshet/error.h"
#include "query/costs/squared_distances.h"
#include "tests/query/costs/made_tables.h"
#include "tests/query/search/made_field.h"

namespace freshet::query {
namespace {

// Eq. 2, 3 and 6, cell by cell, in double precision.
double naive_cost(const FeatureShape& shape, const PairwiseOptions& options, stored::Row a, stored::Row b,
                  bool beside) {
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
double naive_strength(const FeatureShape& shape, const PairwiseOptions& options, stored::Row row) {
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
    for (const stored::Row row : candidates.rows_of(piece))
      strengths.push_back(naive_strength(shape, options, row));
    std::vector<double> sorted = strengths;
    std::sort(sorted.begin(), sorted.end());
    const double median = sorted[sorted.size() / 2];
    for (std::size_t i = 0; i < strengths.size(); ++i) {
      const double expected = 1 - candidates.scores_of(piece)[i] + 3 * std::pow(strengths[i] - median, 2);
      EXPECT_NEAR(mrf.unary_of(piece)[i], expected, 1e-3 * expected + 1e-6);
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
          EXPECT_NEAR(mrf.table(edge)[i * rows_q.size() + j], expected,
                      (form == CostForm::kLog ? 15e-4 : 1e-3) * expected + 1e-9)
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
  std::vector<PairCost> reference;
  for (const int threads : {1, 2, 8}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    const Mrf mrf = build_mrf(target, candidates, shape, {}, source_of(shape));
    if (reference.empty()) reference = mrf.pairwise;
    EXPECT_EQ(mrf.pairwise, reference);
  }
}

std::vector<float> plain_tables(bool power) {
  FILE* program = popen(power ? PLAIN_TABLES " --power" : PLAIN_TABLES, "r");
  std::vector<float> costs;
  for (float cost = 0; std::fread(&cost, sizeof cost, 1, program) == 1;) costs.push_back(cost);
  EXPECT_EQ(pclose(program), 0);
  return costs;
}

TEST(Pairwise, IsTheSameForVectorsOfAnyWidth) {
  for (const bool power : {false, true}) {
    const std::vector<float> wide = made_tables(power), plain = plain_tables(power);
    ASSERT_EQ(wide.size(), plain.size());
    EXPECT_EQ(std::memcmp(wide.data(), plain.data(), wide.size() * sizeof(float)), 0);
  }
}

TEST(Pairwise, ReadsEachSquareOfAPatchOnce) {
  const Target target = some_target();
  const Candidates candidates = some_candidates(target.size(), 40);
  const FeatureShape shape;
  std::set<Square> needed;
  FeatureSource source = source_of(shape);
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    for (const stored::Row row : candidates.rows_of(piece)) {
      Square squares[4];
      source.squares(row, squares);
      needed.insert(std::begin(squares), std::end(squares));
    }
  }
  std::vector<Square> read;
  source.read = [&, inner = source.read](std::span<const Square> squares, const SquareSink& sink) {
    read.insert(read.end(), squares.begin(), squares.end());
    inner(squares, sink);
  };
  build_mrf(target, candidates, shape, {}, source);
  EXPECT_TRUE(std::ranges::equal(read, needed));
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

// Vectors of random length-37 values (no multiple of any vector unit), and their distances in plain loops.
template <class Value>
void check_distances(const std::function<Value()>& draw, double tolerance) {
  for (const std::size_t count_a : {1u, 4u, 7u, 9u, 17u}) {
    for (const std::size_t count_b : {1u, 2u, 8u, 13u}) {
      const std::size_t length = 37;
      Panel<Value> a, b;
      a.resize(count_a, length);
      b.resize(count_b, length);
      for (Panel<Value>* panel : {&a, &b})
        for (std::size_t i = 0; i < panel->count(); ++i) std::generate_n(panel->vector(i), length, draw);
      std::vector<float> found(count_a * count_b, -1), summed(count_a * count_b, 3);
      squared_distances(a, b, 0.5f, Into::kNew, found.data());
      squared_distances(a, b, 0.5f, Into::kSum, summed.data());
      for (std::size_t i = 0; i < count_a; ++i) {
        for (std::size_t j = 0; j < count_b; ++j) {
          double expected = 0;
          for (std::size_t d = 0; d < length; ++d)
            expected += 0.5 * std::pow(static_cast<double>(a.vector(i)[d]) - b.vector(j)[d], 2);
          EXPECT_NEAR(found[i * count_b + j], expected, tolerance * expected);
          EXPECT_EQ(summed[i * count_b + j], 3 + found[i * count_b + j]);
        }
      }
    }
  }
}

TEST(SquaredDistances, ReachEveryPairOfEveryShape) {
  std::mt19937_64 random(6);
  std::normal_distribution<float> normal;
  check_distances<float>([&] { return normal(random); }, 1e-5);
  std::uniform_int_distribution<int> level(-1920, 1920);
  check_distances<std::int16_t>([&] { return static_cast<std::int16_t>(level(random)); }, 1e-7);
}

// A panel used for longer vectors before still ends in zeros.
TEST(SquaredDistances, WholeNumbersAreExactWhereProductsOverflow) {
  Panel<std::int16_t> a, b;
  for (const std::size_t length : {1152u, 1100u}) {
    a.resize(3, length);
    b.resize(3, length);
    for (std::size_t i = 0; i < 3; ++i) {
      std::fill_n(a.vector(i), length, static_cast<std::int16_t>(1920 - i));
      std::fill_n(b.vector(i), length, static_cast<std::int16_t>(i * 7));
    }
    float found[9];
    squared_distances(a, b, 1, Into::kNew, found);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const std::int64_t difference = 1920 - i - 7 * j;
        EXPECT_EQ(found[3 * i + j],
                  static_cast<float>(difference * difference * static_cast<std::int64_t>(length)));
      }
    }
  }
}

}  // namespace
}  // namespace freshet::query
