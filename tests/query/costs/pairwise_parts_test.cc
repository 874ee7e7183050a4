#include "query/costs/pairwise_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "freshet/error.h"
#include "tests/query/search/made_field.h"

namespace freshet::query {
namespace {

TEST(PairwiseParts, CombinedTheyAreBitForBitTheFieldOfTheSameWeights) {
  const Target target = some_target();
  const Candidates candidates = some_candidates(target.size(), 13);
  const FeatureShape shape;
  for (const CostForm form : {CostForm::kLog, CostForm::kPower}) {
    const PairwiseParts parts = find_parts(target, candidates, shape, form, source_of(shape));
    EXPECT_EQ(parts.motion.size() * sizeof(PairCost), table_bytes(target, candidates));
    for (const PairwiseOptions& options :
         {default_costs(form), PairwiseOptions{form, 0.05, 1.7, 0, 2}, PairwiseOptions{form, 0.3, 0, 9, 0},
          PairwiseOptions{form, 0, 1, 1, 4}}) {
      const Mrf alone = build_mrf(target, candidates, shape, options, source_of(shape));
      const Mrf combined = combine(target, candidates, parts, options);
      EXPECT_EQ(combined.unary, alone.unary);
      EXPECT_EQ(combined.pairwise, alone.pairwise);
      EXPECT_EQ(combined.label_count, alone.label_count);
      ASSERT_EQ(combined.edges.size(), alone.edges.size());
    }
  }
}

TEST(PairwiseParts, PiecesThatShareNothingHaveNone) {
  const Target target = some_target();
  const Candidates candidates = some_candidates(target.size(), 3);
  FeatureShape shape;
  shape.overlap = 0;
  const PairwiseParts parts = find_parts(target, candidates, shape, CostForm::kLog, source_of(shape));
  EXPECT_TRUE(parts.motion.empty());
  const Mrf mrf = combine(target, candidates, parts, {});
  EXPECT_EQ(mrf.unary, build_mrf(target, candidates, shape, {}, source_of(shape)).unary);
  EXPECT_EQ(mrf.pairwise, std::vector<PairCost>(mrf.pairwise.size(), 0.0f));
}

TEST(PairwiseParts, OnlyWhatIsWantedIsComputedAndOnlyItsCandidatesAreRead) {
  const Target target = some_target();
  const Candidates candidates = some_candidates(target.size(), 13);
  const FeatureShape shape;
  for (std::size_t edge = 0; edge < target.edges.size(); edge += 5) {
    PartsWanted wanted{std::vector<bool>(target.size()), std::vector<bool>(target.edges.size())};
    wanted.edges[edge] = true;
    const std::uint32_t other = static_cast<std::uint32_t>(target.size() - 1);
    wanted.pieces[other] = true;
    std::set<Row> needed;
    for (const std::uint32_t piece : {target.edges[edge].first, target.edges[edge].second, other})
      needed.insert(candidates.rows_of(piece).begin(), candidates.rows_of(piece).end());
    FeatureSource source = source_of(shape);
    std::set<Row> read;
    source.read = [&, inner = source.read](std::span<const Square> squares, const SquareSink& to) {
      for (const Square& square : squares) read.insert(square.clip);
      inner(squares, to);
    };
    std::vector<std::size_t> edges, pieces;
    const PartsSink sink{[&](std::uint32_t piece, const PieceParts& of) {
                           pieces.push_back(piece);
                           EXPECT_EQ(of.motion.size(), candidates.counts[piece]);
                         },
                         [&](std::size_t e, const EdgeParts& of) {
                           edges.push_back(e);
                           const auto [p, q] = target.edges[e];
                           EXPECT_EQ(of.textureness.size(),
                                     std::size_t{candidates.counts[p]} * candidates.counts[q]);
                         }};
    visit_parts(target, candidates, shape, CostForm::kLog, source, wanted, sink);
    EXPECT_EQ(edges, std::vector<std::size_t>{edge});
    EXPECT_EQ(pieces, std::vector<std::size_t>{other});
    EXPECT_EQ(read, needed);
  }
}

// Overlaps of half a patch, of two thirds, of less than half, and of cells that no square but one fits.
TEST(PairwiseParts, AreTheSameInBatchesOfRowsAndForAnyOverlap) {
  const Target target = some_target();
  const Candidates candidates = some_candidates(target.size(), 13);
  for (const int overlap : {6, 8, 4, 5}) {
    FeatureShape shape;
    shape.overlap = overlap;
    const PairwiseParts parts = find_parts(target, candidates, shape, CostForm::kLog, source_of(shape));
    PartsWanted wanted;
    wanted.memory_bytes = 1;
    FeatureSource source = source_of(shape);
    int readings = 0;
    source.read = [&, inner = source.read](std::span<const Square> squares, const SquareSink& to) {
      ++readings;
      inner(squares, to);
    };
    PairwiseParts batched = parts;
    for (auto* values : {&batched.motion, &batched.dynamics, &batched.textureness, &batched.still_motion})
      std::fill(values->begin(), values->end(), -1.0f);
    std::size_t first_label = 0;
    std::vector<std::size_t> labels, pairs{0};
    for (const std::uint32_t count : candidates.counts) labels.push_back(first_label), first_label += count;
    for (const auto& [p, q] : target.edges)
      pairs.push_back(pairs.back() + std::size_t{candidates.counts[p]} * candidates.counts[q]);
    const PartsSink sink{
        [&](std::uint32_t piece, const PieceParts& of) {
          std::copy(of.motion.begin(), of.motion.end(), batched.still_motion.data() + labels[piece]);
        },
        [&](std::size_t e, const EdgeParts& of) {
          std::copy(of.motion.begin(), of.motion.end(), batched.motion.data() + pairs[e]);
          std::copy(of.dynamics.begin(), of.dynamics.end(), batched.dynamics.data() + pairs[e]);
          std::copy(of.textureness.begin(), of.textureness.end(), batched.textureness.data() + pairs[e]);
        }};
    visit_parts(target, candidates, shape, CostForm::kLog, source, wanted, sink);
    EXPECT_EQ(readings, target.rows);
    EXPECT_EQ(batched.motion, parts.motion);
    EXPECT_EQ(batched.dynamics, parts.dynamics);
    EXPECT_EQ(batched.textureness, parts.textureness);
    EXPECT_EQ(batched.still_motion, parts.still_motion);
  }
}

TEST(PairwiseParts, WeightsBeyondSinglePrecisionAreRefused) {
  const Target target = some_target();
  const Candidates candidates = some_candidates(target.size(), 2);
  const PairwiseParts parts = find_parts(target, candidates, {}, CostForm::kLog, source_of({}));
  for (const double bad : {-1.0, std::nan(""), 1e10})
    EXPECT_THROW(combine(target, candidates, parts, {.rho = bad}), Error) << bad;
}

}  // namespace
}  // namespace freshet::query
