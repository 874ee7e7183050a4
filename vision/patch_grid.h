// vision/patch_grid.h — where patches lie in a frame, and which of them are worth keeping.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::vision {

struct PatchGrid {
  int patch = 48;   // px, side of a patch
  int stride = 24;  // px from a patch to the next
};

/// Top-left corners, row-major, of all patches that lie wholly inside `frame`.
/// mirrored   the grid of a flipped frame is the mirror image of the unflipped one, so that a flipped patch
///            holds exactly the pixels of its twin and shares its descriptors. Still row-major in its own
///            frame: the i-th patch of a row is the twin of the (n - 1 - i)-th.
std::vector<cv::Point> patch_positions(cv::Size frame, const PatchGrid& grid, bool mirrored = false);

/// Fraction of set pixels (non-zero) of mask (CV_8U) inside each patch, 0..1. One integral image a call.
/// Throws Error{kUsage} when a patch does not lie inside the mask.
std::vector<float> patch_coverage(const cv::Mat& mask, const std::vector<cv::Point>& positions, int patch);

}  // namespace freshet::vision
