// query/costs/stored_features.h — features of patches, from the cells that a store keeps of their clips.
#pragma once

#include <span>
#include <vector>

#include "query/costs/pairwise.h"
#include "store/store.h"
#include "stored/patch_table.h"
#include "vision/settings.h"

namespace freshet::query {

/// A source of features that decodes the cells of each clip once a reading and keeps none: a thread at work
/// holds those of one clip (1280 x 720: 9 MB). Borrows the settings and the table.
class StoredFeatures {
 public:
  /// Throws as feature_shape.
  StoredFeatures(const store::Snapshot& snapshot, const vision::Settings& settings,
                 const stored::PatchTable& table);
  StoredFeatures(const store::Snapshot&, const vision::Settings&&, const stored::PatchTable&) = delete;
  StoredFeatures(const store::Snapshot&, const vision::Settings&, const stored::PatchTable&&) = delete;
  StoredFeatures(const store::Snapshot&, const vision::Settings&&, const stored::PatchTable&&) = delete;
  /// This, as build_mrf takes it; must not outlive it. Cost of reading: 20 million cells per second and core,
  /// and the decoding of each clip that is read from.
  FeatureSource source() const&;
  FeatureSource source() && = delete;

 private:
  void squares(stored::Row row, std::span<Square> out) const;
  void read(std::span<const Square> squares, const SquareSink& sink) const;
  void read_clip(std::span<const Square> squares, std::size_t first, const SquareSink& sink) const;

  store::Snapshot snapshot_;
  const vision::Settings& settings_;
  const stored::PatchTable& table_;
  FeatureShape shape_;
  std::vector<vision::Variant> variants_;
};

}  // namespace freshet::query
