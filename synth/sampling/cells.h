// synth/sampling/cells.h — the cells of a lattice that rectangles touch.
#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::sampling {

/// Cells of `cell` px, cut at `within`'s far edges, that any of the rectangles touches; row by row. The
/// lattice begins at `within`'s corner.
std::vector<cv::Rect> cells_touched(std::span<const cv::Rect> rects, const cv::Rect& within, cv::Size cell);

}  // namespace freshet::synth::sampling
