// synth/stills/between/flow_pins.h — points of one still that a person found again in another.
#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::stills {

/// (0, 0) is the middle of the upper left pixel.
struct FlowPin {
  cv::Point2f at, goes;  // px of the flow: in the one still, and in the other
  float reach = 0;       // px of the flow, above 0: farther from it nothing changes

  cv::Point2f move() const { return goes - at; }
};

/// Pins apart by what moves as one: two are together where their moves differ by less than .75 of their
/// distance, so that a motion between them can be turned round, and they are not so far apart that nothing
/// between them is in reach; and so are those that others join. In the order of their first pins.
std::vector<std::vector<FlowPin>> joined_pins(std::span<const FlowPin> pins);

/// The smooth motion that pins which move as one ask for.
class PinnedMotion {
 public:
  /// pins   of one of joined_pins; not empty.
  explicit PinnedMotion(std::vector<FlowPin> pins);

  const std::vector<FlowPin>& pins() const { return pins_; }
  /// px; each pin's own at it, about them the affine map of least squares weighted by 1 / distance^2.
  /// Source   Schaefer, McPhail, Warren 2006, Sec. 2.1 (moving least squares), stiffened where pins are near.
  cv::Point2f move(cv::Point2f at) const;
  /// Three pins or more enclose what lies in their convex hull.
  bool encloses(cv::Point2f at) const;
  /// 1 at the pins, in what they enclose and on the lines between two that lie within twice their reaches, falling
  /// evenly to 0 at the end of the reach.
  float nearness(cv::Point2f at) const;
  /// px from the nearest pin.
  float distance(cv::Point2f at) const;
  /// Whole px of a flow of that size in which nearness is above 0.
  cv::Rect box(cv::Size flow) const;

 private:
  std::vector<FlowPin> pins_;
  std::vector<cv::Point2f> hull_;
};

}  // namespace freshet::synth::stills
