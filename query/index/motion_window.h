// query/index/motion_window.h — the mean motion that a piece's candidates may have.
#pragma once

#include <cmath>
#include <limits>

namespace freshet::query {

/// A sector of directions and a range of speeds; motion in px/s, x right, y down. By default any motion.
struct MotionWindow {
  float u = 0, v = 0;     // unit vector of the direction asked; (0, 0): none is asked
  float min_cosine = -1;  // of the angle to it
  float min_speed = 0, max_speed = std::numeric_limits<float>::infinity();

  bool is_any() const {
    return u == 0 && v == 0 && min_speed <= 0 && max_speed == std::numeric_limits<float>::infinity();
  }
  /// The comparison has a margin of rounding: a patch at the very edge is in.
  bool admits(float mean_u, float mean_v) const {
    const float speed = std::sqrt(mean_u * mean_u + mean_v * mean_v);
    return speed >= min_speed && speed <= max_speed &&
           mean_u * u + mean_v * v >= (u == 0 && v == 0 ? 0 : min_cosine * speed - 1e-6f * speed);
  }
};

}  // namespace freshet::query
