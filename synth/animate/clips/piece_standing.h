// synth/animate/clips/piece_standing.h — how much of the detail in the patches that are shown stays in its place.
#pragma once

#include <vector>

#include "store/store.h"
#include "synth/animate/placement/placement.h"

namespace freshet::synth::animate {

/// By Laplacian level of the picture, finest first, and the low-pass rest: of a band's variance, how much stays where it
/// is while the fluid goes by, 0..1. Means over the pieces (stored::patch_standing). Levels coarser than the clips'
/// cells know go on as those before: the coarser, the more stands. A clip that does not know says nothing; 0 when none
/// does.
/// levels  of the picture; levels + 1 values.
/// Throws  Error{kDamaged} as stored::standing_cells.
/// Cost    one column of each clip; microseconds a piece.
std::vector<double> standing_shares(const store::Snapshot& snapshot, const Placement& placement, int levels);

}  // namespace freshet::synth::animate
