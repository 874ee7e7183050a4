#include "synth/stills/between/flow_pins.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::stills {
namespace {

constexpr float kSteepest = .75f;  // px of move a px of distance

float length(cv::Point2f way) { return std::hypot(way.x, way.y); }

bool near_each_other(const FlowPin& a, const FlowPin& b) {
  return length(a.at - b.at) <= 2 * (a.reach + b.reach);
}

bool together(const FlowPin& a, const FlowPin& b) {
  return near_each_other(a, b) && length(a.move() - b.move()) <= kSteepest * length(a.at - b.at);
}

float distance_to_line(cv::Point2f at, cv::Point2f from, cv::Point2f to) {
  const cv::Point2f way = to - from;
  const float all = way.dot(way);
  const float part = all > 0 ? std::clamp((at - from).dot(way) / all, 0.0f, 1.0f) : 0;
  return length(at - from - part * way);
}

}  // namespace

std::vector<std::vector<FlowPin>> joined_pins(std::span<const FlowPin> pins) {
  std::vector<std::vector<FlowPin>> groups;
  std::vector<char> taken(pins.size(), 0);
  for (std::size_t first = 0; first < pins.size(); ++first) {
    if (taken[first] != 0) continue;
    taken[first] = 1;
    std::vector<FlowPin> group{pins[first]};
    for (std::size_t k = 0; k < group.size(); ++k)
      for (std::size_t i = first + 1; i < pins.size(); ++i)
        if (taken[i] == 0 && together(group[k], pins[i])) {
          taken[i] = 1;
          group.push_back(pins[i]);
        }
    groups.push_back(std::move(group));
  }
  return groups;
}

PinnedMotion::PinnedMotion(std::vector<FlowPin> pins) : pins_(std::move(pins)) {
  if (pins_.size() < 3) return;
  std::vector<cv::Point2f> points;
  for (const FlowPin& pin : pins_) points.push_back(pin.at);
  cv::convexHull(points, hull_);
}

cv::Point2f PinnedMotion::move(cv::Point2f at) const {
  constexpr float kAtIt = 1e-4f;  // px squared
  constexpr float kStiff =
      .02f;  // of the reach squared: nearer pins do not turn or stretch what is about them
  cv::Point2f mean_at(0, 0), mean_move(0, 0);
  float weights = 0, reach = 0;
  const auto weight_of = [&](const FlowPin& pin) {
    const cv::Point2f way = at - pin.at;
    return 1 / (way.dot(way) + kAtIt);
  };
  for (const FlowPin& pin : pins_) {
    const float weight = weight_of(pin);
    mean_at += weight * pin.at;
    mean_move += weight * pin.move();
    weights += weight;
    reach = std::max(reach, pin.reach);
  }
  mean_at *= 1 / weights;
  mean_move *= 1 / weights;
  const float stiff = kStiff * weights * reach * reach;
  cv::Matx22f spread(stiff, 0, 0, stiff), turned = cv::Matx22f::zeros();
  for (const FlowPin& pin : pins_) {
    const float weight = weight_of(pin);
    const cv::Point2f x = pin.at - mean_at, v = pin.move() - mean_move;
    spread += weight * cv::Matx22f(x.x * x.x, x.x * x.y, x.x * x.y, x.y * x.y);
    turned += weight * cv::Matx22f(v.x * x.x, v.x * x.y, v.y * x.x, v.y * x.y);
  }
  const cv::Vec2f off = turned * spread.inv() * cv::Vec2f(at.x - mean_at.x, at.y - mean_at.y);
  return mean_move + cv::Point2f(off[0], off[1]);
}

bool PinnedMotion::encloses(cv::Point2f at) const {
  return !hull_.empty() && cv::pointPolygonTest(hull_, at, false) >= 0;
}

float PinnedMotion::nearness(cv::Point2f at) const {
  if (encloses(at)) return 1;
  float most = 0;
  for (std::size_t i = 0; i < pins_.size(); ++i) {
    most = std::max(most, 1 - length(at - pins_[i].at) / pins_[i].reach);
    for (std::size_t j = 0; j < i; ++j)
      if (near_each_other(pins_[i], pins_[j]))
        most = std::max(most, 1 - distance_to_line(at, pins_[i].at, pins_[j].at) /
                                      std::min(pins_[i].reach, pins_[j].reach));
  }
  return most;
}

float PinnedMotion::distance(cv::Point2f at) const {
  float least = std::numeric_limits<float>::max();
  for (const FlowPin& pin : pins_) least = std::min(least, length(at - pin.at));
  return least;
}

cv::Rect PinnedMotion::box(cv::Size flow) const {
  cv::Point2f low = pins_[0].at, high = pins_[0].at;
  for (const FlowPin& pin : pins_) {
    low = {std::min(low.x, pin.at.x - pin.reach), std::min(low.y, pin.at.y - pin.reach)};
    high = {std::max(high.x, pin.at.x + pin.reach), std::max(high.y, pin.at.y + pin.reach)};
  }
  const cv::Rect all(cv::Point(cvFloor(low.x), cvFloor(low.y)),
                     cv::Point(cvCeil(high.x) + 1, cvCeil(high.y) + 1));
  return all & cv::Rect({}, flow);
}

}  // namespace freshet::synth::stills
