#include "query/stored/patch_standing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "freshet/error.h"
#include "query/stored/clip_cells.h"

namespace freshet::query {
namespace {

constexpr int kSpots = 6;  // across a patch: every 8th px of 48, several in a cell at any scale

}  // namespace

std::optional<vision::CellMap> standing_cells(const store::Snapshot& snapshot, store::ClipId clip) {
  constexpr const char* kColumn = "cells.standing";
  if (!snapshot.has_column(clip, kColumn)) return std::nullopt;
  vision::CellMap cells = clip_cells(snapshot, clip, kColumn, "/cells/standing", vision::kStandingChannels);
  if (!std::all_of(cells.values.begin(), cells.values.end(), [](float v) { return v >= 0 && v <= 1; }))
    throw Error(ErrorKind::kDamaged, snapshot.clip(clip).name + ", column " + kColumn,
                "a share that cannot be", "Run freshet store verify");
  return cells;
}

std::array<double, vision::kLifeBands> patch_standing(const vision::CellMap& standing,
                                                      const vision::VariantFrame& frame, float scale,
                                                      cv::Point patch, int side) {
  std::array<double, vision::kLifeBands> source{}, found{};
  const auto along = [&](int i) { return (i + 0.5) * side / kSpots - 0.5; };
  for (int row = 0; row < kSpots; ++row)
    for (int column = 0; column < kSpots; ++column) {
      const cv::Vec2d at =
          frame.source_from_variant * cv::Vec3d(patch.x + along(column), patch.y + along(row), 1);
      const std::span<const float> values = covering_cell(standing, at);
      for (std::size_t b = 0; b < source.size(); ++b) source[b] += values[b] / (kSpots * kSpots);
    }
  constexpr int kCoarsest = vision::kLifeBands - 1;
  for (int b = 0; b <= kCoarsest; ++b) {
    const double of_source = std::clamp(b - std::log2(static_cast<double>(scale)), 0.0, double{kCoarsest});
    const int finer = std::min(static_cast<int>(of_source), kCoarsest - 1);
    found[b] = std::lerp(source[finer], source[finer + 1], of_source - finer);
  }
  return found;
}

}  // namespace freshet::query
