// synth/animate/assigned.h — an assignment as a placement.
#pragma once

#include "query/assignment.h"
#include "synth/animate/placement.h"

namespace freshet::synth {

/// Finds the assignment's clips in the store. Throws as query::find_clips.
Placement place(const query::Assignment& assignment, const store::Snapshot& snapshot);

}  // namespace freshet::synth
