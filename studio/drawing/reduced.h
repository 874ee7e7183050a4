// studio/drawing/reduced.h — a picture, and what was drawn over it, made smaller.
#pragma once

#include <opencv2/core.hpp>

#include "studio/drawing/document.h"

namespace freshet::studio {

/// By how much a picture is too large for this longer side, px; at least 1.
double reduction(cv::Size size, int side);
/// At least a pixel. The picture itself where factor is at most 1, or it is empty.
cv::Mat reduced(const cv::Mat& picture, double factor);

/// What was drawn for the motion, over a picture reduced by a factor: strokes and directions. Nothing is pinned.
Document reduced(const Document& document, double factor);
/// Layers and their numbers in px.
DrawnScene reduced(const DrawnScene& scene, double factor);

}  // namespace freshet::studio
