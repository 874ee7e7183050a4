// synth/transfer/vote.h — a picture from overlapping patches.
#pragma once

#include "synth/transfer/pixel_grid.h"
#include "synth/transfer/retrieval.h"

namespace freshet::synth::transfer {

/// The floor under a patch's distance keeps a perfect one from speaking alone.
inline constexpr float kVoteFloor = 25.0f * (2.0f / 255) * (2.0f / 255);
/// What a patch at this distance counts: (D + kVoteFloor)^-power.
float vote_weight(float distance, double power);

/// Each pixel becomes the mean of what the patches over it say, by their vote_weight. Pixels that no patch covers are
/// left as they are.
///
/// source  the exemplar's colours, of field's source size.
/// into    of its target size.
/// Source  the M-step of Kwatra et al. 2005; their energy |x - z|^0.8 makes the power 0.6.
void vote(const PixelGrid& source, const NearestField& field, int patch, double power, PixelGrid& into);

}  // namespace freshet::synth::transfer
