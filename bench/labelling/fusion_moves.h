// bench/labelling/fusion_moves.h — fusion moves by QPBO: a solver to compare the product's with.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "query/mrf/max_flow.h"
#include "query/mrf/mrf.h"

namespace freshet::bench {

/// Chooses between two labels at each node at once, whatever the tables: one cut of a graph that holds each
/// node and its negation. Where no cut tells which of the two is better, neither is said to be.
/// Source   Hammer, Hansen and Simeone 1984; Kolmogorov and Rother 2007 (QPBO).
class Fusion {
 public:
  enum class Choice : std::uint8_t { kOpen, kKeep, kTake };

  explicit Fusion(const query::Mrf& mrf) : mrf_(mrf) {}

  /// Some best choice between `labels` and `proposal` agrees with all that are not open. Keeping the label
  /// where it is open never costs more than `labels` do. Valid until the next call.
  std::span<const Choice> choose(const query::Labels& labels, const query::Labels& proposal);

 private:
  void add_term(const query::Mrf::Edge& edge, const query::Labels& labels, const query::Labels& proposal);

  const query::Mrf& mrf_;
  query::MaxFlow flow_;
  std::vector<double> keep_, take_;
  std::vector<Choice> choices_;
};

struct FusionOptions {
  int max_cycles = 20;  // over all proposals; ends earlier when a cycle gains nothing
};

/// Lowers solution.energy, never raises it. Proposals: each rank, as alpha-expansion's, and after every
/// eighth of them what each node would take beside its neighbours' labels as they are.
/// Deterministic, one thread.
/// Source   Lempitsky, Rother, Roth and Blake 2010.
void fusion_moves(const query::Mrf& mrf, query::Solution& solution, const FusionOptions& options = {});

}  // namespace freshet::bench
