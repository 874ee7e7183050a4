// query/mrf/trw_s.h — sequential tree-reweighted message passing.
#pragma once

#include "query/mrf/mrf.h"

namespace freshet::query {

struct TrwsOptions {
  int max_iterations = 100;        // forward and backward passes
  double gap = 1e-3;               // stop when (energy - bound) / |bound| is at most this
  double min_gap_decrease = 1e-5;  // stop when, over five iterations, the gap shrinks by less
};

/// A labelling of low energy and a lower bound that proves how low it could be at best. Tables need be
/// neither metric nor symmetric. Exact on trees.
///
/// Deterministic: the same bits for any number of threads. A node waits only for those nodes before it that
/// share an edge with it. On a lattice each thread goes along a row, one behind the other.
/// Cost     two passes over all tables per iteration: 5 ms of one thread for 943 edges of 124 x 124 labels.
///          Messages are floats, one per edge and label, shared by both directions.
/// Source   Kolmogorov 2006, Sec. 3; our own implementation. Labels are read off the messages in node order,
///          each given its earlier neighbours' labels (ibid. Sec. 3.3), after every iteration; the best is
///          kept.
Solution trw_s(const Mrf& mrf, const TrwsOptions& options = {});

}  // namespace freshet::query
