// quality_structure.h — whether single frames look like the clip's at every size: patches by level.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::bench {

inline constexpr int kPatchLevels = 5, kPatchSide = 7;  // levels fine to coarse; px of their level
inline constexpr int kPatchProjections = 256, kPatchQuantiles = 512;

/// The patches of some frames as distributions: row per projection, ascending quantiles, CV_32F, grey levels.
/// A level that is too small for patches in the matte is empty.
using PatchSample = std::array<cv::Mat, kPatchLevels>;

/// Patches of kPatchSide px, middles in the matte, up to 400 a frame and level, from the spread frames'
/// Laplacian pyramids; the coarsest level is the low-pass rest. Places depend on the matte, the frame's place
/// in the sample and the level alone: a film sampled twice is the same.
/// luma   CV_8U, all of one size. matte CV_8U of it, counted where above 127.
/// Cost   kPatchProjections sorts of up to 6400 values a level. All threads; the same for any number.
/// Source Rabin et al. 2011 (sliced Wasserstein), Karras et al. 2018 (of patches by level).
PatchSample sample_patches(std::span<const cv::Mat> luma, const cv::Mat& matte);
/// Mean |difference| of quantiles over the projections, grey levels; NaN for an empty level.
std::array<double, kPatchLevels> patch_distances(const PatchSample& a, const PatchSample& b);

}  // namespace freshet::bench
