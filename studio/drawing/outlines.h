// studio/drawing/outlines.h — areas of a mask as outlines that a page draws.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

namespace freshet::studio {

/// The outline of each area that hangs together, the largest first, to .7 px. A hole is reached by a cut, there and
/// back, so that the water in a rim around it is not of it. Smaller areas and holes than `least` px are left out.
/// mask   CV_8U, not 0 in them.
std::vector<std::vector<cv::Point>> outlines_of(const cv::Mat& mask, double least);

/// Each as x0, y0, x1, y1, .. px of the picture that the mask is smaller than by a factor, whose corner is 0, 0.
nlohmann::json outlines_json(const std::vector<std::vector<cv::Point>>& outlines, double factor);

}  // namespace freshet::studio
