// stored/patch_life.h — how long a patch's detail lives along its flow, out of its clip's cells.
#pragma once

#include <array>
#include <optional>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "vision/detail_lifetime.h"
#include "vision/variant.h"

namespace freshet::stored {

/// Column "cells.life" of a clip (vision::DetailLifetimes::cells); none in a clip that was ingested before there was
/// one.
/// Throws   Error{kDamaged} as motion_cells, and for values below 0 or lives above vision::kLongestLife_s.
std::optional<vision::CellMap> life_cells(const store::Snapshot& snapshot, store::ClipId clip);

/// By Laplacian band of the patch as it is shown, finest first.
struct PatchLife {
  std::array<double, vision::kLifeBands> half_life_s{};  // of the clip's own seconds; 0: not known
  std::array<double, vision::kLifeBands> power{};        // mean square, luma in 0..1
};

/// Means over the cells that the patch covers: of the logarithm of their half-lives, each by its power in the band, for
/// the detail that is seen is the strong one's; and of the power.
///
/// A variant of scale s shows a source wavelength s times as long: band b of the patch is band b - log2(s) of the
/// source, between two bands by both (logarithms again), beyond the coarsest that one. Turning and mirroring change
/// nothing: a half-life has no direction.
///
/// patch   px, top left corner in the variant's frame (vision::variant_frame); side of `side` px.
/// Nothing is allocated; safe from many threads.
PatchLife patch_life(const vision::CellMap& life, const vision::VariantFrame& frame, float scale,
                     cv::Point patch, int side);

}  // namespace freshet::stored
