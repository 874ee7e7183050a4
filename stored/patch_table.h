// stored/patch_table.h — every patch of a store as columns.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "store/store.h"
#include "vision/settings.h"
#include "vision/spatial_pyramid.h"
#include "vision/variant.h"

namespace freshet::stored {

using Row = std::uint32_t;  // a patch's number: rows of clip 0, then of clip 1, ...
inline constexpr Row kNoRow = 0xffffffff;

/// The patch table. All columns have equal length.
struct PatchTable {
  std::vector<store::ClipId> clips;   // clips in order
  std::vector<Row> first_row;         // clips.size() + 1
  std::vector<std::uint32_t> clip;    // index into `clips`
  std::vector<std::uint8_t> variant;  // index into the settings' variants
  std::vector<std::uint16_t> x, y;    // px, top-left corner in the variant's frame
  std::vector<float> mean_u, mean_v;  // px/s, x right, y down, in the variant's frame
  std::vector<float> coverage;        // 0..1, fraction of pixels that move
  vision::OwnWordMaps words;
  std::size_t size() const { return clip.size(); }
};

/// Reads all patch columns: 110 bytes per patch, 191 with more than 256 words.
/// Throws   Error{kNotFound} "has no index; run freshet index" when words are missing, and when there is no
///          patch at all; Error{kDamaged} when a column is not as long as its clip has rows, a variant is not
///          in the settings, words are not as wide as the settings ask or a patch reaches beyond its frame.
PatchTable read_patch_table(const store::Snapshot& snapshot);

/// Where one clip's patches lie: what is known of them before there is an index.
struct ClipPatches {
  std::vector<std::uint8_t> variant;
  std::vector<std::uint16_t> x, y;
};
/// Checked as in read_patch_table. variants   settings.variants().
ClipPatches read_clip_patches(const store::Snapshot& snapshot, const vision::Settings& settings,
                              std::span<const vision::Variant> variants, store::ClipId clip);

}  // namespace freshet::stored
