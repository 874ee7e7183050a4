// query/mrf/forest_descent.h — large exact moves: the best labels of a forest while the rest is held.
#pragma once

#include "query/mrf/mrf.h"

namespace freshet::query {

struct ForestDescentOptions {
  int max_cycles = 20;     // a cycle's forests cover every node; ends when a cycle gains nothing
  std::uint64_t seed = 1;  // of the orders in which nodes are offered to a forest
};

/// Lowers solution.energy, never raises it; labels only change when it falls. Bound and iterations are kept.
///
/// A forest takes as many nodes as it can without closing a cycle: on a grid about two thirds of them. Its
/// minimum is found by dynamic programming. The result is a local minimum of every such move, and of ICM's.
/// Sweeps over rows and columns are special cases of these trees. Deterministic for a seed, one thread.
/// Cost     less than an iteration of TRW-S a forest.
/// Source   Hamze and de Freitas 2004, Sec. 3 (there for sampling).
void forest_descent(const Mrf& mrf, Solution& solution, const ForestDescentOptions& options = {});

}  // namespace freshet::query
