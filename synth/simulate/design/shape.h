// synth/simulate/design/shape.h — where a shape of a design lies, pixel by pixel.
#pragma once

#include <opencv2/core.hpp>

#include "synth/simulate/scene/design.h"

namespace freshet::synth::simulate {

/// A value on a line of (seconds, value) knots: straight between them, level outside. At least one knot.
float value_at(const std::vector<std::pair<float, float>>& knots, double time_s);
/// How far a shape has moved, fractions of width and height; (0, 0) without knots.
Vec2 shift_at(const Shape& shape, double time_s);

/// How much of each pixel the shape covers, 0..1, with its centre moved by `shift`.
/// coverage  of the picture's size, all of it overwritten.
/// Returns the rectangle outside of which coverage is 0; empty when the shape lies outside the picture.
/// Cost  O(pixels of that rectangle x corners).
cv::Rect draw_shape(const Shape& shape, Vec2 shift, Grid& coverage);

}  // namespace freshet::synth::simulate
