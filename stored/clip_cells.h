// stored/clip_cells.h — a clip's motion and textureness cells out of a store.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "stored/clip_metadata.h"
#include "vision/settings.h"
#include "vision/temporal_spectrum.h"

namespace freshet::stored {

/// A column of cells.
/// shape    as the clip's metadata give it; nothing: they do not.
/// Throws   Error{kDamaged} when the column is of another length or has a value that is no number, and when the shape
///          is missing or not of as many channels; Error{kNotFound} when the column is missing.
vision::CellMap clip_cells(const store::Snapshot& snapshot, store::ClipId clip, const std::string& column,
                           const std::optional<CellShape>& shape, int channels);

/// Rows and columns of cells are derived from the clip's
/// size (a cell at the right or lower edge may overhang), as vision's accumulators make them.
/// Throws   as clip_cells and metadata_of.
vision::CellMap motion_cells(const store::Snapshot& snapshot, const vision::Settings& settings,
                             store::ClipId clip);
/// scale   index into settings.scales.
vision::CellMap texture_cells(const store::Snapshot& snapshot, const vision::Settings& settings,
                              store::ClipId clip, std::size_t scale);
/// The cell that covers a place of the source (px; a pixel's middle is whole), outside the nearest one.
inline std::span<const float> covering_cell(const vision::CellMap& cells, const cv::Vec2d& source) {
  const auto index = [&](double px, int count) {
    return std::clamp(static_cast<int>(std::floor((px + 0.5) / cells.cell)), 0, count - 1);
  };
  return cells.at(index(source[1], cells.rows), index(source[0], cells.columns));
}
/// Index into settings.scales of a variant's scale.
std::size_t scale_index(const vision::Settings& settings, const vision::Variant& variant);

}  // namespace freshet::stored
