// bench/harness/features_of_patches.h — whole patches' features, for loops that check the costs of squares.
#pragma once

#include <span>
#include <vector>

#include "query/costs/pairwise.h"

namespace freshet::bench {

/// All features of patches, shape.values() each, as vision::patch_features lays them out.
std::vector<float> features_of_patches(const query::FeatureSource& source, const query::FeatureShape& shape,
                                       std::span<const stored::Row> rows);

}  // namespace freshet::bench
