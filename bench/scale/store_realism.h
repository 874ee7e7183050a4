// bench/scale/store_realism.h — how two sets of patches differ in their words and in their neighbours.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "query/index/candidate_index.h"
#include "vision/spatial_pyramid.h"

namespace freshet::bench {

/// Fraction of each word among all grid points; sums to 1. word_count values.
std::vector<double> word_fractions(std::span<const vision::WordMap> words, int word_count);

/// Half the sum of absolute differences: 0 the same, 1 nothing in common.
double total_variation(std::span<const double> p, std::span<const double> q);

/// Kullback-Leibler divergence of p from q, bits. Words that one lacks count as a millionth of all.
double divergence_bits(std::span<const double> p, std::span<const double> q);

/// Distinct bins of a patch's spatial pyramid (cell and word), of at most 243: mean.
double mean_bins(std::span<const vision::WordMap> words, int word_count);

/// Scores / max_score, 0..1, of the patches that stand at ranks 1, 10 and 100: means over the queries.
struct NeighbourScores {
  double first = 0, tenth = 0, hundredth = 0;
};
/// Error{kUsage} with less than 100 rows admitted.
NeighbourScores neighbour_scores(const query::CandidateIndex& index,
                                 std::span<const query::PieceQuery> queries);

/// The best score / max_score of each query among the allowed rows.
std::vector<double> best_scores(const query::CandidateIndex& index,
                                std::span<const query::PieceQuery> queries, const query::RowFilter& allowed);

/// A patch as a query: all of its points count.
query::PieceQuery query_of(const vision::WordMap& words);

}  // namespace freshet::bench
