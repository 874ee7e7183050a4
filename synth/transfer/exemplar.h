// synth/transfer/exemplar.h — one moment of the exemplar, ready to be searched at every level.
#pragma once

#include <cstdint>
#include <vector>

#include "synth/transfer/features.h"
#include "synth/transfer/segments.h"
#include "synth/transfer/transfer.h"

namespace freshet::synth::transfer {

/// With four turns, the turned pictures lie one below the other, each in a square of side `block`.
struct ExemplarLevel {
  PixelGrid now;
  Features features;
  Segments segments;
  int block = 0;                // 0 for one turn
  std::vector<cv::Size> sizes;  // of the picture, by turn

  /// The turn in which a place lies, and its x and y there.
  struct Place {
    int x, y, turn;
  };
  Place split(int place) const;
  int join(Place at) const { return (at.y + at.turn * block) * now.width + at.x; }
};

struct PreparedExemplar {
  std::vector<ExemplarLevel> levels;  // the finest first
  cv::Size size;
  bool opaque = false;           // no pixel is transparent
  std::vector<VectorGrid> back;  // ExemplarFrame::back by turn, of the finest level; empty: not stabilised
};

/// previous   the frame before; it may be the same.
/// levels     at most; fewer where a level would have no patch.
/// Throws     Error{kInput} as Transfer::next says.
PreparedExemplar prepare(const ExemplarFrame& frame, const ExemplarFrame& previous, int levels,
                         const TransferOptions& options);

/// Where what lay at places of the finest level, in the frame before, lies now, as near as whole px come; -1:
/// outside. The flow of a place is taken for the one that led away from it, as carried() does.
void follow(const PreparedExemplar& exemplar, GridOf<std::int32_t>& places);

}  // namespace freshet::synth::transfer
