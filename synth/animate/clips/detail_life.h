// synth/animate/clips/detail_life.h — how long the detail of a clip lives while the fluid carries it.
#pragma once

#include "store/store.h"
#include "vision/settings.h"

namespace freshet::synth::animate {

/// Seconds after which detail, followed along the clip's own flow, keeps half of its correlation with itself: luma
/// less its blur (sigma 4 px at 320 px width), from a few frames on, over at most 24 frames; where more than half
/// is left by then, the fall goes on as it did, to at most 6 s. Only what moves is followed. 1 for a clip of less
/// than three frames, or in which nothing moves.
/// Throws   Error{kDamaged} as reading frames and flow.
/// Cost     33 frames of the clip and their flow, on the calling thread: .1 to .2 s at 1280 x 720.
double detail_half_life_s(const store::Snapshot& snapshot, store::ClipId clip);

}  // namespace freshet::synth::animate
