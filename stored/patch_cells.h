// stored/patch_cells.h — which cells of its clip a patch covers, and which bands of it it shows.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include <opencv2/core.hpp>

#include "stored/clip_cells.h"
#include "vision/detail_lifetime.h"
#include "vision/variant.h"

namespace freshet::stored {

inline constexpr int kSpots = 6;  // across a patch: every 8th px of 48, several in a cell at any scale

/// Calls with the values of the cell under each of kSpots x kSpots places, evenly spread over a patch.
/// patch   px, top left corner in the variant's frame; side of `side` px.
template <class Use>
void each_spot(const vision::CellMap& cells, const vision::VariantFrame& frame, cv::Point patch, int side,
               const Use& use) {
  const auto along = [&](int i) { return (i + 0.5) * side / kSpots - 0.5; };
  for (int row = 0; row < kSpots; ++row)
    for (int column = 0; column < kSpots; ++column) {
      const cv::Vec2d at =
          frame.source_from_variant * cv::Vec3d(patch.x + along(column), patch.y + along(row), 1);
      use(covering_cell(cells, at));
    }
}

/// A place among the source's bands: between two of them.
struct BandPlace {
  int finer;        // and the next coarser one
  double fraction;  // of the coarser one
};
/// A variant of scale s shows a source wavelength s times as long: band b of it is band b - log2(s) of the source,
/// beyond the coarsest that one, and before the finest that.
inline BandPlace source_band(int band, float scale) {
  const double at = std::clamp(band - std::log2(static_cast<double>(scale)), 0.0, vision::kLifeBands - 1.0);
  const int finer = std::min(static_cast<int>(at), vision::kLifeBands - 2);
  return {finer, at - finer};
}

}  // namespace freshet::stored
