// stored/clip_schema.h — the columns of a stored clip: their names, and the types of their rows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "store/store.h"
#include "vision/flow_outliers.h"
#include "vision/spatial_pyramid.h"

namespace freshet::stored {

/// A column of a clip. T is the type of its rows.
template <class T>
struct Column {
  const char* name;

  /// Throws as store::Snapshot::column.
  std::vector<T> read(const store::Snapshot& snapshot, store::ClipId clip) const {
    return snapshot.column<T>(clip, name);
  }
  bool is_in(const store::Snapshot& snapshot, store::ClipId clip) const {
    return snapshot.has_column(clip, name);
  }
  void write(store::ClipWriter& writer, std::span<const T> rows) const { writer.column<T>(name, rows); }
};

// A row per frame.
inline constexpr Column<double> kFrameTime{"frame.time"};  // s

// A row per flow frame.
inline constexpr Column<double> kFlowRate{
    "flow.rate"};  // pairs of frames per second; only where the rate varies
inline constexpr Column<vision::FlowOutlier> kFlowOutlier{"flow.outlier"};

// A row per patch.
inline constexpr Column<std::uint8_t> kPatchVariant{"patch.variant"};  // index into the settings' variants
inline constexpr Column<std::uint16_t> kPatchX{"patch.x"};  // px, top left corner, in the variant's frame
inline constexpr Column<std::uint16_t> kPatchY{"patch.y"};
inline constexpr Column<std::array<float, 2>> kPatchMotion{
    "patch.motion"};                                              // px/s, mean u and v, in its frame
inline constexpr Column<float> kPatchCoverage{"patch.coverage"};  // 0..1, fraction of pixels that move

/// The column of visual words, of the index: word maps as wide as the settings' number of words asks for.
struct WordColumn {
  const char* name;

  bool is_in(const store::Snapshot& snapshot, store::ClipId clip) const {
    return snapshot.has_column(clip, name);
  }
  /// Throws as store::Snapshot::column, and Error{kDamaged} where words are not of so many bytes.
  vision::OwnWordMaps read(const store::Snapshot& snapshot, store::ClipId clip, int word_bytes) const;
  store::Store::Column column(store::ClipId clip, vision::WordMaps rows) const {
    return {clip, name, rows.bytes(), static_cast<std::uint32_t>(rows.row_bytes())};
  }
};
inline constexpr WordColumn kPatchWords{"patch.words"};

// A row of floats per cell, row by row; the metadata hold the shapes (clip_metadata.h).
inline constexpr const char* kMotionCells = "cells.motion";      // vision/temporal_spectrum.h
inline constexpr const char* kLifeCells = "cells.life";          // vision::DetailLifetimes::cells
inline constexpr const char* kStandingCells = "cells.standing";  // vision::DetailLifetimes::standing
inline constexpr const char* kLayoutCells = "cells.layout";      // vision::DetailLifetimes::layout
/// vision/textureness.h, of a scale of the settings.
inline std::string texture_cells_name(std::size_t scale) { return "cells.texture." + std::to_string(scale); }

}  // namespace freshet::stored
