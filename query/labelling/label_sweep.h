// query/labelling/label_sweep.h — one picture labelled with many weights, for little more than one.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "query/labelling/labelling.h"

namespace freshet::query {

/// What may differ from one labelling of a sweep to the next: nothing that candidates depend on.
struct LabelVariation {
  PairwiseOptions costs{};
  Minimizer minimizer = Minimizer::kTrwS;
  int max_iterations = 100;
};

struct SweptLabelling {
  Assignment assignment;
  Labels labels;
  int iterations = 0;
};

struct SweepOptions {
  GuideCosts guide_costs{};
  ReuseCosts reuse{};
  /// For parts, 12 bytes per label pair, and a table of 2 for each labelling at work. Where the
  /// parts do not fit (a field of more than some 7000 pieces), each labelling compares neighbours
  /// by itself, one after another.
  std::size_t memory_bytes = std::size_t{1500} << 20;
};

/// A labelling for each variation, in their order: bit for bit those that label() gives with the same
/// options. Neighbours are compared once for each form of costs; solvers run beside each other.
/// progress   called from many threads with the number of labellings done; may be empty.
/// Throws     as check_weights, before anything is computed, and Error{kCancelled}.
std::vector<SweptLabelling> label_variations(const store::Snapshot& snapshot, const CandidateSearch& search,
                                             std::span<const LabelVariation> variations,
                                             const SweepOptions& options = {},
                                             const std::function<void(std::size_t done)>& progress = {},
                                             std::stop_token stop = {});

}  // namespace freshet::query
