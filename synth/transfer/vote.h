// synth/transfer/vote.h — a picture from overlapping patches.
#pragma once

#include "synth/transfer/pixel_grid.h"
#include "synth/transfer/retrieval.h"

namespace freshet::synth::transfer {

/// Each pixel becomes the mean of what the patches over it say, weighed by (D + 25 (2 / 255)^2)^-power. The
/// floor under D keeps a perfect patch from speaking alone. Pixels that no patch covers are left as they are.
///
/// source  the exemplar's colours, of field's source size.
/// into    of its target size.
/// Source  the M-step of Kwatra et al. 2005; their energy |x - z|^0.8 makes the power 0.6.
void vote(const PixelGrid& source, const NearestField& field, int patch, double power, PixelGrid& into);

}  // namespace freshet::synth::transfer
