// hints/svg_path.h — the d attribute of an SVG path, as cubic curves.
#pragma once

#include <string_view>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::hints {

/// One unbroken line: a first point, then two control points and an end point for each curve. Straight parts
/// are curves too: one way to transform and flatten them all.
struct SvgSubpath {
  std::vector<cv::Point2d> points;  // 1 + 3 n
};

/// All commands of SVG 1.1, section 8.3: M L H V C S Q T A Z, absolute and relative, repeated implicitly.
/// Subpaths without any curve (a lone M) are left out, as a browser does. Arcs are within 3e-4 of their
/// radius. Throws SvgFault, also above a million curves.
std::vector<SvgSubpath> parse_svg_path(std::string_view d);

/// "x,y x,y ..." of a polyline. Throws SvgFault: an odd number of them.
std::vector<cv::Point2d> parse_svg_points(std::string_view points);

/// A chain of points no further than `tolerance` from the curves, at most 256 a curve.
std::vector<cv::Point2f> flatten(const SvgSubpath& subpath, double tolerance);

}  // namespace freshet::hints
