// query/trw_s.h — sequential tree-reweighted message passing.
#pragma once

#include "query/mrf.h"

namespace freshet::query {

struct TrwsOptions {
  int max_iterations = 100;  // forward and backward passes
  double min_gap_decrease =
      1e-5;  // stop when, over five iterations, (energy - bound) / |bound| shrinks by less
};

/// A labelling of low energy and a lower bound that proves how low it could be at best.
/// Tables need be neither metric nor symmetric. Exact on trees. Deterministic; runs on the calling thread.
/// Cost     two passes over all tables an iteration: 10 ms for 955 edges of 100 x 100 labels (memory bound).
///          Messages are floats, one an edge and label, shared by both directions.
/// Source   Kolmogorov 2006, Sec. 3; our own implementation. Labels are read off the messages in node order,
///          each given its earlier neighbours' labels (ibid. Sec. 3.3), after every iteration; the best is
///          kept.
Solution trw_s(const Mrf& mrf, const TrwsOptions& options = {});

}  // namespace freshet::query
