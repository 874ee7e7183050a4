#include "studio/drawing/outlines.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace freshet::studio {
namespace {

using Outline = std::vector<cv::Point>;

constexpr double kTolerance = .7;  // px

Outline simplified(const Outline& outline) {
  Outline simple;
  cv::approxPolyDP(outline, simple, kTolerance, true);
  return simple;
}

/// Goes into the hole where both come nearest to each other.
void cut_to(Outline& outline, Outline hole) {
  std::size_t from = 0, to = 0;
  int nearest = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < outline.size(); ++i)
    for (std::size_t j = 0; j < hole.size(); ++j) {
      const cv::Point off = outline[i] - hole[j];
      if (off.dot(off) >= nearest) continue;
      nearest = off.dot(off);
      from = i;
      to = j;
    }
  std::ranges::rotate(hole, hole.begin() + static_cast<std::ptrdiff_t>(to));
  hole.push_back(hole.front());
  hole.push_back(outline[from]);
  outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(from) + 1, hole.begin(), hole.end());
}

}  // namespace

std::vector<Outline> outlines_of(const cv::Mat& mask, double least) {
  std::vector<Outline> contours;
  std::vector<cv::Vec4i> tree;  // the next, the one before, the first hole, what it is a hole of
  cv::findContours(mask, contours, tree, cv::RETR_CCOMP, cv::CHAIN_APPROX_SIMPLE);
  std::vector<std::pair<double, Outline>> areas;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const double area = cv::contourArea(contours[i]);
    if (tree[i][3] >= 0 || area < least) continue;
    Outline& outline = areas.emplace_back(area, simplified(contours[i])).second;
    for (int hole = tree[i][2]; hole >= 0; hole = tree[static_cast<std::size_t>(hole)][0]) {
      const Outline& around = contours[static_cast<std::size_t>(hole)];
      if (cv::contourArea(around) >= least) cut_to(outline, simplified(around));
    }
  }
  std::ranges::stable_sort(areas, std::greater{}, [](const auto& area) { return area.first; });
  std::vector<Outline> outlines;
  for (auto& [area, outline] : areas) outlines.push_back(std::move(outline));
  return outlines;
}

nlohmann::json outlines_json(const std::vector<Outline>& outlines, double factor) {
  nlohmann::json json = nlohmann::json::array();
  for (const Outline& outline : outlines) {
    nlohmann::json& points = json.emplace_back(nlohmann::json::array());
    for (const cv::Point& point : outline) {
      // Whole pixels have their number at their middle.
      points.push_back(std::round(10 * factor * (point.x + 0.5)) / 10);
      points.push_back(std::round(10 * factor * (point.y + 0.5)) / 10);
    }
  }
  return json;
}

}  // namespace freshet::studio
