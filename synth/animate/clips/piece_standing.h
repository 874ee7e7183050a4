// synth/animate/clips/piece_standing.h — how much of the detail in the patches that are shown stays in its place, and
// of where it is strong.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "synth/animate/placement/placement.h"

namespace freshet::synth::animate {

/// By Laplacian level of the picture, finest first, and the low-pass rest: of a band's variance, how much stays where
/// it is while the fluid goes by, 0..1. Means over the pieces (stored::patch_standing). Levels coarser than the clips'
/// cells know go on as those before: the coarser, the more stands. A clip that does not know says nothing; 0 when none
/// does.
/// levels  of the picture; levels + 1 values.
/// Throws  Error{kDamaged} as stored::standing_cells.
/// Cost    one column of each clip; microseconds a piece.
std::vector<double> standing_shares(const store::Snapshot& snapshot, const Placement& placement, int levels);
/// By Laplacian level of the picture, finest first: how far what is seen of it is a layout that stands, 0..1, on the
/// pieces' lattice (PieceValues::none). Of patches whose local contrast stays (stored::patch_layout) by less than .05,
/// nothing; by .25 or more, all. In the band of 8 px clouds, smoke and seas have 0 to .04, a swell .1, rapids .15,
/// brooks, rivers and a fall .28 to .43. Levels coarser than the clips' cells know are as those before. A clip that
/// does not know has none.
/// levels  of the picture, >= 1.
/// Throws  Error{kDamaged} as stored::layout_cells.
std::vector<cv::Mat> layout_shares(const store::Snapshot& snapshot, const Placement& placement, int levels);

}  // namespace freshet::synth::animate
