// studio/drawing/direction_brush.h — a brush that was drawn along the flow, as lines beside each other.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "studio/drawing/drawn.h"

namespace freshet::studio {

/// Five lines across each band, along it; they end where a later band lies over it, and at the picture's edges. What
/// does not add takes away what lies below it.
/// brush   not areas. picture   px. Cost   of drawing the bands once, at most 1024 px wide and high.
std::vector<DrawnStroke> brush_strokes(const std::vector<Drawn>& brush, cv::Size picture);

}  // namespace freshet::studio
