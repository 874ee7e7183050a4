// studio/drawing/drawn.h — lines and areas as a pointer draws them.
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::studio {

inline constexpr double kFurthest = 1e6;  // px that a point lies from (0, 0), along an axis, at most
inline constexpr double kWidest = 10000;  // px of a brush

/// A line or an area that was drawn, px of the picture; (0, 0) is the outer corner of its first pixel.
struct Drawn {
  std::vector<cv::Point2f> points;
  float width = 0;       // px; 0 of an area
  bool adds = true;      // false: it takes away (paint), or says that there is no fluid (scribbles)
  bool is_area = false;  // closed and filled
  bool operator==(const Drawn&) const = default;
};

struct DrawnStroke {
  std::vector<cv::Point2f> points;  // as the fluid goes
  std::optional<float> speed{};     // px/s; nothing: not said
  bool operator==(const DrawnStroke&) const = default;
};

}  // namespace freshet::studio
