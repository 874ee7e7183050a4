// synth/transfer/state_file.h — what a frame leaves to the next, in a file.
#pragma once

#include <cstdint>
#include <filesystem>

#include "synth/transfer/pixel_grid.h"
#include "synth/transfer/transfer.h"

namespace freshet::synth::transfer {

struct State {
  int frame = 0;      // the next one's index
  PixelGrid picture;  // of the frame before, without motion blur; empty before frame 0, as the three below
  Grid mask;          // its target alpha
  VectorGrid flow;
  GridOf<std::int32_t> sources;  // where in the exemplar's finest level each patch was from; -1: no patch
};

/// File    "FRTRANS2", a digest of the options, frame, width, height, the four fields row by row as 32-bit
///         numbers, and a hash of all before it; little-endian. Written to a neighbour, renamed when whole.
/// Throws  Error{kIo}.
void write_state(const std::filesystem::path& path, const State& state, const TransferOptions& options);

/// Throws  Error{kInput}: missing, cut, damaged, written with other options. The length is checked before
///         anything is allocated.
State read_state(const std::filesystem::path& path, const TransferOptions& options);

}  // namespace freshet::synth::transfer
