// hints/svg_transform.h — where SVG puts what it draws.
#pragma once

#include <string_view>

#include <opencv2/core.hpp>

namespace freshet::hints {

inline cv::Point2d transformed(const cv::Matx33d& transform, const cv::Point2d& point) {
  return {transform(0, 0) * point.x + transform(0, 1) * point.y + transform(0, 2),
          transform(1, 0) * point.x + transform(1, 1) * point.y + transform(1, 2)};
}

/// A transform attribute: matrix, translate, scale, rotate (about a point too), skewX, skewY, in any number.
/// Throws SvgFault.
cv::Matx33d parse_svg_transform(std::string_view text);

/// From user units to a viewport whose upper left corner is (0, 0), as viewBox and preserveAspectRatio say.
/// fit   the attribute; empty: "xMidYMid meet". Throws SvgFault.
cv::Matx33d svg_viewport(const cv::Rect2d& view_box, cv::Size2d viewport, std::string_view fit);

}  // namespace freshet::hints
