// synth/transfer/target_level.h — one moment of the design, ready to be searched for at every level.
#pragma once

#include <vector>

#include "synth/transfer/features.h"
#include "synth/transfer/pixel_grid.h"
#include "synth/transfer/segments.h"
#include "synth/transfer/transfer.h"

namespace freshet::synth::transfer {

/// The target at one level of the pyramid. Everything has a margin of patch / 2 px on all sides, so that a patch
/// around any pixel of the frame is whole.
struct TargetLevel {
  Grid blurred_alpha, lambda;
  PixelGrid previous;
  Segments segments;
  Features features;  // all but the channels of the frame that is being made
};

/// The frame before, as this frame sees it: carried along the flow, and how much it counts at each pixel (Eq. 6).
/// Of the frame's size, without a margin.
struct Past {
  PixelGrid picture;
  Grid lambda;
};

/// So many levels, the finest first. All grids are of the frame's size.
std::vector<TargetLevel> target_levels(Grid blurred_alpha, Past past, std::size_t levels,
                                       const TransferOptions& options);

/// The frame within the margin that a level has around it.
PixelGrid without_margin(const PixelGrid& grid, int margin);

}  // namespace freshet::synth::transfer
