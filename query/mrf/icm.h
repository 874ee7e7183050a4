// query/mrf/icm.h — iterated conditional modes: one node at a time to its best label.
#pragma once

#include "query/mrf/mrf.h"

namespace freshet::query {

struct IcmOptions {
  int max_sweeps = 100;  // over all nodes, in order; ends earlier when a sweep changes nothing
};

/// A local minimum reached from the labels of minimum unary cost. Deterministic, one thread.
/// Source   Besag 1986.
Solution icm(const Mrf& mrf, const IcmOptions& options = {});

}  // namespace freshet::query
