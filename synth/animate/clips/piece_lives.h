// synth/animate/clips/piece_lives.h — how long detail lives in the patches that are shown, piece by piece.
#pragma once

#include <array>
#include <vector>

#include "store/store.h"
#include "synth/animate/placement/placement.h"
#include "vision/detail_lifetime.h"

namespace freshet::synth::animate {

/// Values by Laplacian band of a piece, finest first.
using LifeBands = std::array<double, vision::kLifeBands>;

/// Rows are the placement's patches.
struct PieceLives {
  /// Seconds of the animation after which a band, followed along the patch's flow, keeps half of its correlation with
  /// itself: the patch's own (stored::patch_life), over the speed at which it plays. > 0.
  std::vector<LifeBands> half_life_s;
  std::vector<LifeBands> power;  // mean square of the patch's bands, luma in 0..1
  /// Of all together: of each piece the mean of the logarithm over its three finest bands, by their power, for what is
  /// coarser than 16 px is form, not detail; of the pieces the median, for a few that show standing water would make a
  /// whole river stand. Beside the mean over four bands and all pieces (bench_quality, 34 clips, strokes with speeds,
  /// when it was chosen) the measure lifetime is .15 instead of .17, water's .19 instead of .24.
  double overall_s = 1;
  double forms_s = 1;  // of the coarsest band: the mean of the logarithm
};

/// What is not known takes the mean (of the logarithm) of the band's other pieces; a band that no piece knows the next
/// finer one's, or the next coarser; with none at all (clips that were ingested before lives were measured) 1 s.
/// Throws   Error{kDamaged} as stored::life_cells.
/// Cost     one column of each clip; microseconds a piece.
PieceLives piece_lives(const store::Snapshot& snapshot, const Placement& placement);

}  // namespace freshet::synth::animate
