#include "query/costs/pairwise_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "freshet/error.h"
#include "tests/query/search/made_field.h"

namespace freshet::query {
namespace {

/// The parts of a whole field.
struct PairwiseParts {
  std::vector<float> still_motion, still_dynamics;   // as Mrf::unary
  std::vector<float> motion, dynamics, textureness;  // as Mrf::pairwise
};

PairwiseParts find_parts(const Target& target, const Candidates& candidates, const FeatureShape& shape,
                         CostForm form) {
  PairwiseParts parts;
  std::vector<std::size_t> first_label{0}, first_pair{0};
  for (const std::uint32_t count : candidates.counts) first_label.push_back(first_label.back() + count);
  for (const auto& [p, q] : target.edges)
    first_pair.push_back(first_pair.back() + std::size_t{candidates.counts[p]} * candidates.counts[q]);
  for (auto* values : {&parts.still_motion, &parts.still_dynamics}) values->resize(first_label.back());
  for (auto* values : {&parts.motion, &parts.dynamics, &parts.textureness}) values->resize(first_pair.back());
  const auto put = [](std::span<const float> from, std::vector<float>& to, std::size_t at) {
    std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(at));
  };
  const PartsSink sink{[&](std::uint32_t piece, const PieceParts& of) {
                         put(of.motion, parts.still_motion, first_label[piece]);
                         put(of.dynamics, parts.still_dynamics, first_label[piece]);
                       },
                       [&](std::size_t edge, const EdgeParts& of) {
                         put(of.motion, parts.motion, first_pair[edge]);
                         put(of.dynamics, parts.dynamics, first_pair[edge]);
                         put(of.textureness, parts.textureness, first_pair[edge]);
                       }};
  visit_parts(target, candidates, shape, form, source_of(shape), {}, sink);
  return parts;
}

TEST(PairwiseParts, CombinedTheyAreBitForBitTheFieldOfTheSameWeights) {
  const Target target = some_target();
  const Candidates candidates = some_candidates(target.size(), 13);
  const FeatureShape shape;
  for (const CostForm form : {CostForm::kLog, CostForm::kPower}) {
    const PairwiseParts parts = find_parts(target, candidates, shape, form);
    for (const PairwiseOptions& options :
         {default_costs(form), PairwiseOptions{form, 0.05, 1.7, 0, 2}, PairwiseOptions{form, 0.3, 0, 9, 0}}) {
      const Mrf alone = build_mrf(target, candidates, shape, options, source_of(shape));
      Mrf combined = unconnected_field(target, candidates);
      for (std::size_t piece = 0; piece < combined.nodes(); ++piece) {
        const std::size_t first = combined.first_unary[piece], count = combined.label_count[piece];
        add_votes({std::span(parts.still_motion).subspan(first, count),
                   std::span(parts.still_dynamics).subspan(first, count)},
                  options, std::span(combined.unary).subspan(first, count));
      }
      weigh({parts.motion, parts.dynamics, parts.textureness}, options, combined.pairwise);
      EXPECT_EQ(combined.unary, alone.unary);
      EXPECT_EQ(combined.pairwise, alone.pairwise);
    }
  }
}

TEST(PairwiseParts, PiecesThatShareNothingHaveNone) {
  const Target target = some_target();
  const Candidates candidates = some_candidates(target.size(), 3);
  FeatureShape shape;
  shape.overlap = 0;
  int visited = 0;
  const PartsSink sink{[&](std::uint32_t, const PieceParts&) { ++visited; },
                       [&](std::size_t, const EdgeParts&) { ++visited; }};
  visit_parts(target, candidates, shape, CostForm::kLog, source_of(shape), {}, sink);
  EXPECT_EQ(visited, 0);
  const Mrf mrf = build_mrf(target, candidates, shape, {}, source_of(shape));
  EXPECT_EQ(mrf.unary, unconnected_field(target, candidates).unary);
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
    std::set<stored::Row> needed;
    for (const std::uint32_t piece : {target.edges[edge].first, target.edges[edge].second, other})
      needed.insert(candidates.rows_of(piece).begin(), candidates.rows_of(piece).end());
    FeatureSource source = source_of(shape);
    std::set<stored::Row> read;
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
    const PairwiseParts parts = find_parts(target, candidates, shape, CostForm::kLog);
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
  for (const double bad : {-1.0, std::nan(""), 1e10}) EXPECT_THROW(check_weights({.rho = bad}), Error) << bad;
}

}  // namespace
}  // namespace freshet::query
