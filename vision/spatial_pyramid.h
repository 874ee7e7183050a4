// vision/spatial_pyramid.h — histograms of visual words over a 3-level spatial pyramid.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vision/dense_sift.h"

namespace freshet::vision {

/// The words of a patch's 9 x 9 grid, row-major: a whole spatial pyramid in 81 bytes.
using WordMap = std::array<std::uint8_t, kGridSide * kGridSide>;
/// For a target piece: 1 where a grid point lies in the fluid and counts.
using WordMask = std::array<std::uint8_t, kGridSide * kGridSide>;

inline constexpr int kPyramidCells = 1 + 4 + 16;
/// Weights of levels 0, 1, 2 as integers: Lazebnik et al. 2006 give 1/4, 1/4, 1/2.
inline constexpr std::array<int, 3> kLevelWeights{1, 1, 2};

/// The pyramid cells (one per level) of grid point (column, row), numbered 0..20: level 0 is 0, level 1
/// is 1..4, level 2 is 5..20.
std::array<int, 3> cells_of(int column, int row);

/// Weighted histogram intersection of two word maps, counted the slow and obvious way: 0..mass of a.
/// Source: Okabe et al. 2011, Eq. 1; Lazebnik, Schmid, Ponce 2006, Eq. 3.
int intersection(const WordMap& a, const WordMap& b, int word_count, const WordMask* mask_of_a = nullptr);

}  // namespace freshet::vision
