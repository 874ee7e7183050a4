// synth/transfer/forward_warp.h — the previous frame where its fluid has gone.
#pragma once

#include <cstdint>

#include "synth/transfer/pixel_grid.h"

namespace freshet::synth::transfer {

struct WarpedFrame {
  PixelGrid picture;
  Grid mask;
};

/// Every pixel is laid down at its place + flow, on the four pixels around it. Where several meet, they are
/// averaged by their opacity, so that fluid covers the empty pixels that it flows over; where none comes,
/// everything is 0.
///
/// mask  the previous frame's target alpha, as large as picture and flow.
WarpedFrame forward_warp(const PixelGrid& picture, const Grid& mask, const VectorGrid& flow);

/// Eq. 6: lambda where there was fluid, less where it is new, 0 where an emitter has just made it.
Grid local_lambda(const Grid& mask, const Grid& warped_mask, double lambda);

/// What lay at the place from which the flow brings each pixel, as near as whole px come; -1: outside. The flow
/// there is taken for the one here, which it is where it is smooth: addresses have no gaps, and no averages.
GridOf<std::int32_t> carried(const GridOf<std::int32_t>& addresses, const VectorGrid& flow);

}  // namespace freshet::synth::transfer
