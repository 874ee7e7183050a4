// stored/patch_standing.h — how much of a patch's detail, and of its local contrast, stays in its place while the flow
// goes by.
#pragma once

#include <array>
#include <optional>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "vision/detail_lifetime.h"
#include "vision/variant.h"

namespace freshet::stored {

/// Column "cells.standing" of a clip (vision::DetailLifetimes::standing); none in a clip that was ingested before there
/// was one.
/// Throws   Error{kDamaged} as motion_cells, and for values outside 0..1.
std::optional<vision::CellMap> standing_cells(const store::Snapshot& snapshot, store::ClipId clip);

/// Column "cells.layout" of a clip (vision::DetailLifetimes::layout); none in a clip that was ingested before there was
/// one.
/// Throws   as standing_cells.
std::optional<vision::CellMap> layout_cells(const store::Snapshot& snapshot, store::ClipId clip);

/// By Laplacian band of the patch as it is shown, finest first: of the band's variance, 0..1. Means over the cells that
/// the patch covers. A variant of scale s shows band b - log2(s) of the source, as patch_life has it.
///
/// patch   px, top left corner in the variant's frame (vision::variant_frame); side of `side` px.
/// Nothing is allocated; safe from many threads.
std::array<double, vision::kLifeBands> patch_standing(const vision::CellMap& standing,
                                                      const vision::VariantFrame& frame, float scale,
                                                      cv::Point patch, int side);
/// The same of its local contrast: what stays in its place and does not go along, 0..1. Where both are found, as where
/// the contrast is drawn out along the flow, it goes as well as it stands.
std::array<double, vision::kLifeBands> patch_layout(const vision::CellMap& layout,
                                                    const vision::VariantFrame& frame, float scale,
                                                    cv::Point patch, int side);

}  // namespace freshet::stored
