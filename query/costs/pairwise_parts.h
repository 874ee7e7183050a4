// query/costs/pairwise_parts.h — what neighbours' unlikeness consists of, before it is weighed.
//
// W is linear in lambda, lambda * sigma and lambda * rho: three tables per edge serve all weights.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "query/costs/pairwise.h"
#include "query/mrf/mrf.h"
#include "query/search/candidates.h"
#include "query/search/target.h"

namespace freshet::query {

/// Of one edge, label_count[p] rows of label_count[q] values each: means over the cells of the overlap.
struct EdgeParts {
  std::span<const float> motion, dynamics, textureness;
};

/// Of one piece, a value per candidate: the same beside a patch that stands still, over all of its cells.
struct PieceParts {
  std::span<const float> motion, dynamics;
};

/// Which parts are wanted. Empty: all.
struct PartsWanted {
  std::vector<bool> pieces, edges;
  /// For features. Where those of all pieces do not fit, they are read in batches of rows of pieces, and what
  /// two batches share is read twice; two rows are held in any case (half a megabyte per piece).
  std::size_t memory_bytes = std::size_t{512} << 20;
};

/// Where parts go; what is handed over lasts for the call. Both are called from many threads, once per piece
/// and once per edge.
struct PartsSink {
  std::function<void(std::uint32_t piece, const PieceParts&)> piece;
  std::function<void(std::size_t edge, const EdgeParts&)> edge;
};

/// Computes parts; only features of candidates that a wanted part needs are read. Nothing when pieces do not
/// overlap. Cost and memory as build_mrf. Throws Error{kCancelled} when stopped.
void visit_parts(const Target& target, const Candidates& candidates, const FeatureShape& shape, CostForm form,
                 const FeatureSource& source, const PartsWanted& wanted, const PartsSink& sink,
                 std::stop_token stop = {});

/// out = lambda * (motion + sigma * dynamics + rho * textureness).
void weigh(const EdgeParts& parts, const PairwiseOptions& options, std::span<PairCost> out);
/// Adds each candidate's price for its distance from the median of their strengths (PairwiseOptions::vote).
void add_votes(const PieceParts& parts, const PairwiseOptions& options, std::span<float> unary);

}  // namespace freshet::query
