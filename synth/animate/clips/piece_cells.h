// synth/animate/clips/piece_cells.h — the cells of the clips that a placement shows, patch by patch.
#pragma once

#include <map>
#include <optional>

#include "store/store.h"
#include "synth/animate/placement/placement.h"
#include "vision/temporal_spectrum.h"
#include "vision/variant.h"

namespace freshet::synth::animate {

/// Calls use(patch, cells, frame) for each patch, in order: cells is null where its clip has none, frame the variant's.
/// read   of (snapshot, clip): its cells, if it has any. Called once a clip.
template <class Read, class Use>
void each_piece(const store::Snapshot& snapshot, const Placement& placement, const Read& read,
                const Use& use) {
  std::map<store::ClipId, std::optional<vision::CellMap>> cells_of;
  for (const PlacedPatch& patch : placement.patches) {
    const auto [cells, first] = cells_of.try_emplace(patch.clip);
    if (first) cells->second = read(snapshot, patch.clip);
    const store::ClipRecord& record = snapshot.clip(patch.clip);
    const cv::Size source(static_cast<int>(record.width), static_cast<int>(record.height));
    use(patch, cells->second ? &*cells->second : nullptr, vision::variant_frame(source, patch.variant));
  }
}

}  // namespace freshet::synth::animate
