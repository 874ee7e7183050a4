// synth/scene/motion/boat_ride.h — what floats rides the waves (Chuang et al. 2005, Sec. 3.4).
#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/motion/motion.h"
#include "synth/scene/motion/water_surface.h"
#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// A line that moved: its middle by `heave`, and by `roll` about it.
struct Ride {
  cv::Point2d heave{};  // px
  double roll = 0;      // rad, clockwise as seen
};
/// The regression line through displaced points of a line. points   px, along the line, not all alike.
/// Residuals are measured across the line as drawn, not upright: a hull may be drawn at any angle.
Ride ride_of(std::span<const cv::Point2d> points, std::span<const cv::Point2d> displaced);

/// How many points of a hull the water is asked at.
int points_along(const Line& hull);

/// Adds the water's own d' to that of n pixels: to what is mirrored in it. copy, x, y   as Motion::row.
void add_waves(const WaterSurface& water, int copy, int x, int y, int n, float* dx, float* dy);

/// A rigid motion in the picture's plane; its inverse is exact. A reflection heaves and rolls the other way (their
/// future work), and what lies in the water is moved by its waves besides.
class BoatRide : public Motion {
 public:
  /// water   of the layer that it floats on; gone to the same frame before this is.
  BoatRide(const BoatMotion& boat, const WaterSurface& water, bool reflection, const cv::Rect& region);

  void go_to(int frame) override;
  float reach() const override;
  void row(int copy, int x, int y, int n, float* dx, float* dy) const override;

 private:
  BoatMotion boat_;
  const WaterSurface* water_;
  bool reflection_;
  cv::Rect region_;
  std::vector<cv::Point2d> points_, displaced_;
  cv::Point2d middle_;
  Ride ride_;
};

}  // namespace freshet::synth::scene
