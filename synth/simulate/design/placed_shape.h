// synth/simulate/design/placed_shape.h — an emitter's or obstacle's shape as it lies now.
#pragma once

#include <opencv2/core.hpp>

#include "synth/simulate/scene/design.h"

namespace freshet::synth::simulate {

class PlacedShape {
 public:
  /// Lies nowhere yet. The shape is borrowed.
  PlacedShape(const Shape& shape, cv::Size picture, cv::Size cells);

  /// Draws the shape where it lies then. True when it has moved.
  bool place(double time_s);

  const Shape& shape() const { return *shape_; }
  Vec2 shift() const { return shift_; }
  const cv::Rect& bounds() const { return bounds_; }    // px: coverage is 0 outside
  const Grid& coverage() const { return coverage_; }    // of the picture, 0..1
  const Grid& cell_coverage() const { return cells_; }  // its mean over each cell

 private:
  const Shape* shape_;
  Vec2 shift_{1e9f, 1e9f};
  cv::Rect bounds_;
  Grid coverage_, cells_;
};

/// Means of a picture's field over the cells that touch `bounds`; the others are left alone.
void cell_means(const Grid& field, cv::Rect bounds, Grid& cells);

}  // namespace freshet::synth::simulate
