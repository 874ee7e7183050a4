// query/stored_features.h — features of patches, from the cells that a store keeps of their clips.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "query/pairwise.h"
#include "query/patch_table.h"
#include "store/store.h"
#include "vision/motion_cells.h"
#include "vision/settings.h"

namespace freshet::query {

/// Reads a clip's cells when one of its patches is first asked for, and drops those that the pieces in hand
/// do not need when they outgrow `cache_bytes` (a 640 x 480 clip: 2.6 MB).
class StoredFeatures {
 public:
  StoredFeatures(const store::Snapshot& snapshot, const vision::Settings& settings, const PatchTable& table,
                 std::size_t cache_bytes = std::size_t{1} << 30);
  void prepare(std::span<const Row> rows);
  /// Only of rows that prepare() was last called with. Safe from many threads.
  void read(Row row, std::span<float> features) const;
  /// This, as build_mrf takes it; must not outlive it.
  FeatureSource source() &;

 private:
  struct ClipCells {
    vision::CellMap motion;
    std::map<std::size_t, vision::CellMap> texture;      // by scale
    std::map<std::size_t, vision::VariantFrame> frames;  // by variant
    std::size_t bytes() const;
  };
  const store::Snapshot& snapshot_;
  const vision::Settings& settings_;
  const PatchTable& table_;
  std::size_t cache_bytes_;
  std::vector<vision::Variant> variants_;
  std::map<std::uint32_t, ClipCells> clips_;  // by index into table.clips
};

}  // namespace freshet::query
