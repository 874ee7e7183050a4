#include "synth/animate/placement/assigned.h"

namespace freshet::synth::animate {

Placement placement_from(const query::Assignment& assignment, const store::Snapshot& snapshot) {
  const std::vector<store::ClipId> clips = query::find_clips(assignment, snapshot);
  Placement placement{.side = assignment.side,
                      .stride = assignment.stride,
                      .piece_scale = assignment.piece_scale,
                      .patches = {}};
  placement.patches.reserve(assignment.pieces.size());
  for (const query::AssignedPiece& piece : assignment.pieces)
    placement.patches.push_back(
        {.piece = piece.corner, .clip = clips[piece.clip], .variant = piece.variant, .patch = piece.patch});
  return placement;
}

}  // namespace freshet::synth::animate
