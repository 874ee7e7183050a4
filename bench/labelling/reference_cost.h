// bench/labelling/reference_cost.h — pairwise tables against the plain loops of Eq. 2, 3 and 6.
#pragma once

#include <cstddef>

#include "query/costs/pairwise.h"
#include "query/labelling/labelling.h"

namespace freshet::bench {

struct TableError {
  std::size_t edges = 0, pairs = 0;
  double relative = 0, absolute = 0;  // largest
  double loop_seconds = 0;            // CPU, of the plain loops alone
};

/// Ten tables of the field, all pairs of labels, against loops over cells and channels in double precision.
/// features   what the tables were built from.
TableError check_tables(const query::Mrf& mrf, const query::CandidateSearch& search,
                        const query::FeatureShape& shape, const query::PairwiseOptions& options,
                        const query::FeatureSource& source);

/// Errors relative to a cost, or to kCostThatMatters where it is less (a step of likeness is 3e-3).
inline constexpr double kErrorAllowed = 1.5e-3, kCostThatMatters = 0.3;

}  // namespace freshet::bench
