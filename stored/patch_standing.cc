#include "stored/patch_standing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "freshet/error.h"
#include "stored/clip_cells.h"
#include "stored/clip_metadata.h"
#include "stored/clip_schema.h"
#include "stored/patch_cells.h"

namespace freshet::stored {

namespace {

std::optional<vision::CellMap> shares_in(const store::Snapshot& snapshot, store::ClipId clip,
                                         const char* column, std::optional<CellShape> CellShapes::*shape,
                                         int channels) {
  if (!snapshot.has_column(clip, column)) return std::nullopt;
  vision::CellMap cells =
      clip_cells(snapshot, clip, column, metadata_of(snapshot, clip).cells.*shape, channels);
  if (!std::all_of(cells.values.begin(), cells.values.end(), [](float v) { return v >= 0 && v <= 1; }))
    throw Error(ErrorKind::kDamaged, snapshot.clip(clip).name + ", column " + column,
                "a share that cannot be", "Run freshet store verify");
  return cells;
}

using Bands = std::array<double, vision::kLifeBands>;

/// Of the patch's bands, means of kLifeBands channels from `first` on over the cells that it covers.
Bands bands_of(const vision::CellMap& cells, std::size_t first, const vision::VariantFrame& frame,
               float scale, cv::Point patch, int side) {
  Bands source{}, found{};
  each_spot(cells, frame, patch, side, [&](std::span<const float> values) {
    for (std::size_t b = 0; b < source.size(); ++b) source[b] += values[first + b] / (kSpots * kSpots);
  });
  for (int b = 0; b < vision::kLifeBands; ++b) {
    const auto [finer, fraction] = source_band(b, scale);
    found[b] = std::lerp(source[finer], source[finer + 1], fraction);
  }
  return found;
}

}  // namespace

std::optional<vision::CellMap> standing_cells(const store::Snapshot& snapshot, store::ClipId clip) {
  return shares_in(snapshot, clip, kStandingCells, &CellShapes::standing, vision::kStandingChannels);
}

std::optional<vision::CellMap> layout_cells(const store::Snapshot& snapshot, store::ClipId clip) {
  return shares_in(snapshot, clip, kLayoutCells, &CellShapes::layout, vision::kLayoutChannels);
}

std::array<double, vision::kLifeBands> patch_standing(const vision::CellMap& standing,
                                                      const vision::VariantFrame& frame, float scale,
                                                      cv::Point patch, int side) {
  return bands_of(standing, 0, frame, scale, patch, side);
}

std::array<double, vision::kLifeBands> patch_layout(const vision::CellMap& layout,
                                                    const vision::VariantFrame& frame, float scale,
                                                    cv::Point patch, int side) {
  Bands share = bands_of(layout, 0, frame, scale, patch, side);
  const Bands goes = bands_of(layout, vision::kLifeBands, frame, scale, patch, side);
  for (std::size_t b = 0; b < share.size(); ++b) share[b] *= 1 - goes[b];
  return share;
}

}  // namespace freshet::stored
