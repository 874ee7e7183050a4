// synth/transfer/target_level.h — one moment of the design, ready to be searched for at every level.
#pragma once

#include <algorithm>
#include <cstdint>
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
  GridOf<std::int32_t> sources;  // the patches of the frame before, as State has them; -1: none, or new fluid
};

/// Whether most of the fluid at a pixel was there in the frame before, by its lambda of Eq. 6.
inline bool has_past(float local_lambda, double lambda) {
  return static_cast<double>(local_lambda) > 0.5 * lambda;
}

/// So many levels, the finest first. All grids are of the frame's size.
std::vector<TargetLevel> target_levels(Grid blurred_alpha, Guides guides, Past past, std::size_t levels,
                                       const TransferOptions& options);

/// The frame within the margin that a level has around it.
template <typename T>
GridOf<T> without_margin(const GridOf<T>& grid, int margin) {
  GridOf<T> out(grid.width - 2 * margin, grid.height - 2 * margin);
  for (int y = 0; y < out.height; ++y) std::copy_n(grid.row(y + margin) + margin, out.width, out.row(y));
  return out;
}

}  // namespace freshet::synth::transfer
