// synth/animate/placement/assigned.h — an assignment as a placement.
#pragma once

#include "query/labelling/assignment.h"
#include "synth/animate/placement/placement.h"

namespace freshet::synth::animate {

/// Finds the assignment's clips in the store. Throws as query::find_clips.
Placement placement_from(const query::Assignment& assignment, const store::Snapshot& snapshot);

}  // namespace freshet::synth::animate
