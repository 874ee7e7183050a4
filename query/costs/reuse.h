// query/costs/reuse.h — what it costs neighbours to show the same place of a clip twice.
#pragma once

#include "query/mrf/mrf.h"
#include "query/search/candidates.h"
#include "query/search/target.h"
#include "store/store.h"
#include "vision/settings.h"

namespace freshet::query {

/// Two neighbouring pieces with the same patch are a stamp that a viewer sees at once; with patches of one clip
/// that overlap there, but lie otherwise than the pieces do, half of one. So a pair pays
///   overlap * fraction of the patches' extent in the clip that both show, 0..1,
/// except that patches which continue each other pay nothing: they show the clip as it was.
struct ReuseCosts {
  double overlap = 0.1;  // 0.3 does no more
  /// Of each patch of a clip that has more than half of the pieces, in each round (mrf/spread.h); 0: one round.
  double crowd = 0.02;
};

/// Adds them to the field's tables. Turned, scaled and mirrored patches count by where they lie in the clip.
/// mrf     nodes and edges in the order of target's, labels in that of candidates.
/// Cost    15 million pairs (500 pieces of 124 candidates): 0.1 s of CPU.
void add_reuse_costs(const store::Snapshot& snapshot, const vision::Settings& settings,
                     const stored::PatchTable& table, const Target& target, const Candidates& candidates,
                     const ReuseCosts& weights, Mrf& mrf);

}  // namespace freshet::query
