#include "stored/patch_standing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "freshet/error.h"
#include "stored/clip_cells.h"
#include "stored/clip_schema.h"
#include "stored/patch_cells.h"

namespace freshet::stored {

std::optional<vision::CellMap> standing_cells(const store::Snapshot& snapshot, store::ClipId clip) {
  if (!snapshot.has_column(clip, kStandingCells)) return std::nullopt;
  vision::CellMap cells = clip_cells(snapshot, clip, kStandingCells,
                                     metadata_of(snapshot, clip).cells.standing, vision::kStandingChannels);
  if (!std::all_of(cells.values.begin(), cells.values.end(), [](float v) { return v >= 0 && v <= 1; }))
    throw Error(ErrorKind::kDamaged, snapshot.clip(clip).name + ", column " + kStandingCells,
                "a share that cannot be", "Run freshet store verify");
  return cells;
}

std::array<double, vision::kLifeBands> patch_standing(const vision::CellMap& standing,
                                                      const vision::VariantFrame& frame, float scale,
                                                      cv::Point patch, int side) {
  std::array<double, vision::kLifeBands> source{}, found{};
  each_spot(standing, frame, patch, side, [&](std::span<const float> values) {
    for (std::size_t b = 0; b < source.size(); ++b) source[b] += values[b] / (kSpots * kSpots);
  });
  for (int b = 0; b < vision::kLifeBands; ++b) {
    const auto [finer, fraction] = source_band(b, scale);
    found[b] = std::lerp(source[finer], source[finer + 1], fraction);
  }
  return found;
}

}  // namespace freshet::stored
