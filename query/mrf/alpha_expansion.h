// query/mrf/alpha_expansion.h — graph cuts by expansion moves: what the paper used.
#pragma once

#include "query/mrf/mrf.h"

namespace freshet::query {

struct AlphaExpansionOptions {
  int max_cycles = 20;  // over all ranks; ends earlier when a cycle gains nothing
};

/// A labelling that no expansion of one rank improves (as far as truncated terms allow).
///
/// An expansion lets every node keep its label or take label number `rank` of its own list; nodes with fewer
/// labels keep theirs. Our labels are candidates, unrelated between nodes, and squared distances are no
/// metric: a third of the terms are not submodular. Such a term is truncated on purpose: the cost of keeping
/// both labels is lowered until it is submodular, which never lets a move raise the energy. A move that does
/// not lower the true energy is not taken. Exact for two labels when all terms are submodular.
///
/// Kept as the paper's baseline: on our problems it ends 2 to 6 % above TRW-S, and has no bound
/// (docs/measurements/labelling.md). Deterministic, one thread.
/// Source   Boykov, Veksler, Zabih 2001; truncation as Rother, Kumar, Kolmogorov, Blake 2005, Sec. 3.
Solution alpha_expansion(const Mrf& mrf, const AlphaExpansionOptions& options = {});

}  // namespace freshet::query
