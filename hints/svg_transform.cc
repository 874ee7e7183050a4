#include "hints/svg_transform.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "hints/svg_scanner.h"

namespace freshet::hints {
namespace {

cv::Matx33d translation(double x, double y) { return {1, 0, x, 0, 1, y, 0, 0, 1}; }

cv::Matx33d one_transform(const std::string& name, const std::vector<double>& n) {
  const auto takes = [&](std::initializer_list<std::size_t> counts) {
    if (std::find(counts.begin(), counts.end(), n.size()) == counts.end())
      throw SvgFault(name + " has " + std::to_string(n.size()) + " numbers");
  };
  constexpr double kDegree = std::numbers::pi / 180;
  if (name == "matrix") {
    takes({6});
    return {n[0], n[2], n[4], n[1], n[3], n[5], 0, 0, 1};
  }
  if (name == "translate") {
    takes({1, 2});
    return translation(n[0], n.size() > 1 ? n[1] : 0);
  }
  if (name == "scale") {
    takes({1, 2});
    return {n[0], 0, 0, 0, n.size() > 1 ? n[1] : n[0], 0, 0, 0, 1};
  }
  if (name == "rotate") {
    takes({1, 3});
    const double c = std::cos(n[0] * kDegree), s = std::sin(n[0] * kDegree);
    const cv::Matx33d turn(c, -s, 0, s, c, 0, 0, 0, 1);
    return n.size() == 1 ? turn : translation(n[1], n[2]) * turn * translation(-n[1], -n[2]);
  }
  if (name == "skewX") {
    takes({1});
    return {1, std::tan(n[0] * kDegree), 0, 0, 1, 0, 0, 0, 1};
  }
  if (name == "skewY") {
    takes({1});
    return {1, 0, 0, std::tan(n[0] * kDegree), 1, 0, 0, 0, 1};
  }
  throw SvgFault("\"" + name + "\" is no transform");
}

}  // namespace

cv::Matx33d parse_svg_transform(std::string_view text) {
  SvgScanner scanner(text);
  cv::Matx33d transform = cv::Matx33d::eye();
  scanner.skip_comma();
  while (!scanner.at_end()) {
    const std::string name(scanner.word());
    if (name == "none" && scanner.at_end()) break;
    if (name.empty() || scanner.take() != '(') throw SvgFault("no transform " + scanner.place());
    std::vector<double> numbers;
    while (scanner.starts_number() && numbers.size() < 7) {
      numbers.push_back(scanner.number());
      // Style sheets write units.
      const std::string_view unit = scanner.word();
      if (!unit.empty() && unit != "px" && unit != "deg")
        throw SvgFault("\"" + std::string(unit) + "\" in " + name);
      scanner.skip_comma();
    }
    if (scanner.take() != ')') throw SvgFault(name + " does not end " + scanner.place());
    transform = transform * one_transform(name, numbers);
    scanner.skip_comma();
  }
  return transform;
}

cv::Matx33d svg_viewport(const cv::Rect2d& view_box, cv::Size2d viewport, std::string_view fit) {
  double scale_x = viewport.width / view_box.width, scale_y = viewport.height / view_box.height;
  double align_x = 0.5, align_y = 0.5;
  if (fit.find("none") == std::string_view::npos) {
    const bool slice = fit.find("slice") != std::string_view::npos;
    scale_x = scale_y = slice ? std::max(scale_x, scale_y) : std::min(scale_x, scale_y);
    const auto align = [&](const char* low, const char* high) {
      return fit.find(low) != std::string_view::npos    ? 0.0
             : fit.find(high) != std::string_view::npos ? 1.0
                                                        : 0.5;
    };
    align_x = align("xMin", "xMax");
    align_y = align("YMin", "YMax");
  }
  const double x = align_x * (viewport.width - view_box.width * scale_x),
               y = align_y * (viewport.height - view_box.height * scale_y);
  return {scale_x, 0, x - view_box.x * scale_x, 0, scale_y, y - view_box.y * scale_y, 0, 0, 1};
}

}  // namespace freshet::hints
