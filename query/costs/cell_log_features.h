// query/costs/cell_log_features.h — the logarithms of a cell's features, which neighbours are compared by.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "query/costs/pairwise.h"

namespace freshet::query {

/// What W weighs against each other.
enum Part { kMotion, kDynamics, kTextureness };
inline constexpr std::size_t kParts = 3;

/// Channels of each part in a cell: 2, two a band, one per level of textureness.
std::array<std::size_t, kParts> part_channels(const FeatureShape& shape);

/// Log features of CostForm::kLog are whole numbers, kLogSteps of them to one of the logarithm: a step is
/// .4 % of a speed. They take half the bytes of floats, and sums of their squares are exact in any order.
/// Against log features in single precision, labellings of real pictures differ by less than 1e-5 of their
/// energy (docs/measurements/labelling.md).
inline constexpr float kLogSteps = 256;
/// What is larger counts as this: 4,500 px/s of motion, an amplitude of 1,800 px/s.
inline constexpr int kMaxLogStep = 1920;
/// The most values of a part for which two patches' sum of squared differences stays below 2^32.
constexpr std::size_t max_values(Part part) { return part == kMotion ? 512 : 1152; }

/// Log features of some cells, part by part, each part cell by cell. Their distances are those of kLog (whole
/// numbers) or of kPower (floats), whose raw power goes by the same name.
/// features       as vision::patch_features, a multiple of shape.channels() values.
/// log_features   as many.
/// Cost           kLog: 50 ns per cell of 22 values with AVX-512.
void find_log_features(const FeatureShape& shape, std::span<const float> features,
                       std::span<std::int16_t> log_features);
void find_log_features(const FeatureShape& shape, std::span<const float> features,
                       std::span<float> log_features);

}  // namespace freshet::query
