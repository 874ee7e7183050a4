// synth/simulate/design/shape.cc
#include "synth/simulate/design/shape.h"

#include <algorithm>
#include <cmath>

#include "synth/field/portable_math.h"

namespace freshet::synth::simulate {
namespace {

float dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
Vec2 minus(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
float length(Vec2 a) { return std::sqrt(dot(a, a)); }

float to_segment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 way = minus(b, a), here = minus(p, a);
  const float square = dot(way, way);
  const float t = square > 0.0f ? std::clamp(dot(here, way) / square, 0.0f, 1.0f) : 0.0f;
  return length(minus(here, {way.x * t, way.y * t}));
}

/// Below 0 inside. Even-odd: a corner that crosses over itself leaves a hole.
float to_polygon(Vec2 p, const std::vector<Vec2>& corners) {
  float nearest = 1e9f;
  bool inside = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Vec2 a = corners[i], b = corners[j];
    nearest = std::min(nearest, to_segment(p, a, b));
    if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) inside = !inside;
  }
  return inside ? -nearest : nearest;
}

float distance(const Shape& shape, Vec2 p) {
  const std::vector<Vec2>& points = shape.points;
  switch (shape.kind) {
    case Shape::Kind::kDisc:
      return length(minus(p, points[0])) - shape.radius;
    case Shape::Kind::kLine:
      return to_segment(p, points[0], points[1]) - shape.radius;
    case Shape::Kind::kPolygon:
      return to_polygon(p, points);
    case Shape::Kind::kPicture:
      break;
  }
  return 0.0f;
}

float sample(const cv::Mat& picture, float x, float y) {
  const Tap tx = tap(x, picture.cols), ty = tap(y, picture.rows);
  const auto at = [&](int row, int column) {
    return static_cast<float>(picture.at<std::uint8_t>(row, column));
  };
  const float top = lerp(at(ty.index, tx.index), at(ty.index, tx.index + tx.step), tx.weight);
  const float bottom =
      lerp(at(ty.index + ty.step, tx.index), at(ty.index + ty.step, tx.index + tx.step), tx.weight);
  return lerp(top, bottom, ty.weight) / 255.0f;
}

cv::Rect draw_picture(const Shape& shape, Vec2 shift, Grid& coverage) {
  const float w = static_cast<float>(coverage.width), h = static_cast<float>(coverage.height);
  const float wide = static_cast<float>(shape.picture.cols), high = static_cast<float>(shape.picture.rows);
  for_rows(coverage.height, [&](int y) {
    const float from_y = (static_cast<float>(y) + 0.5f) / h - shift.y;
    for (int x = 0; x < coverage.width; ++x) {
      const float from_x = (static_cast<float>(x) + 0.5f) / w - shift.x;
      const bool within = from_x >= 0.0f && from_x < 1.0f && from_y >= 0.0f && from_y < 1.0f;
      coverage(x, y) = within ? sample(shape.picture, from_x * wide - 0.5f, from_y * high - 0.5f) : 0.0f;
    }
  });
  int x0 = coverage.width, y0 = coverage.height, x1 = 0, y1 = 0;
  for (int y = 0; y < coverage.height; ++y) {
    for (int x = 0; x < coverage.width; ++x) {
      if (coverage(x, y) <= 0.0f) continue;
      x0 = std::min(x0, x), x1 = std::max(x1, x + 1), y0 = std::min(y0, y), y1 = std::max(y1, y + 1);
    }
  }
  return x1 > x0 ? cv::Rect(x0, y0, x1 - x0, y1 - y0) : cv::Rect();
}

}  // namespace

float value_at(const std::vector<std::pair<float, float>>& knots, double time_s) {
  const float t = static_cast<float>(time_s);
  if (t <= knots.front().first) return knots.front().second;
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const auto& [t0, a] = knots[i - 1];
    const auto& [t1, b] = knots[i];
    if (t < t1) return lerp(a, b, (t - t0) / (t1 - t0));
  }
  return knots.back().second;
}

Vec2 shift_at(const Shape& shape, double time_s) {
  if (shape.move.empty()) return {};
  const float t = static_cast<float>(time_s);
  if (t <= shape.move.front().first) return shape.move.front().second;
  for (std::size_t i = 1; i < shape.move.size(); ++i) {
    const auto& [t0, a] = shape.move[i - 1];
    const auto& [t1, b] = shape.move[i];
    if (t < t1) return {lerp(a.x, b.x, (t - t0) / (t1 - t0)), lerp(a.y, b.y, (t - t0) / (t1 - t0))};
  }
  return shape.move.back().second;
}

cv::Rect draw_shape(const Shape& shape, Vec2 shift, Grid& coverage) {
  if (shape.kind == Shape::Kind::kPicture) return draw_picture(shape, shift, coverage);
  std::fill(coverage.values.begin(), coverage.values.end(), 0.0f);
  // In pixels, which are square.
  const float w = static_cast<float>(coverage.width), h = static_cast<float>(coverage.height);
  Shape scaled = shape;
  scaled.radius *= h;
  const float rim = std::max(shape.softness * h, 0.5f);
  const float reach = rim + (shape.kind == Shape::Kind::kPolygon ? 0.0f : scaled.radius);
  float x0 = 1e9f, y0 = 1e9f, x1 = -1e9f, y1 = -1e9f;
  for (Vec2& p : scaled.points) {
    p = {(p.x + shift.x) * w - 0.5f, (p.y + shift.y) * h - 0.5f};
    x0 = std::min(x0, p.x - reach), x1 = std::max(x1, p.x + reach);
    y0 = std::min(y0, p.y - reach), y1 = std::max(y1, p.y + reach);
  }
  const auto pixel = [](float x, int size) {
    return static_cast<int>(std::clamp(x, 0.0f, static_cast<float>(size)));
  };
  const cv::Rect bounds(cv::Point(pixel(x0, coverage.width), pixel(y0, coverage.height)),
                        cv::Point(pixel(x1 + 2.0f, coverage.width), pixel(y1 + 2.0f, coverage.height)));
  for_rows(bounds.height, [&](int row) {
    const int y = bounds.y + row;
    for (int x = bounds.x; x < bounds.x + bounds.width; ++x) {
      const float d = distance(scaled, {static_cast<float>(x), static_cast<float>(y)});
      coverage(x, y) = smoothstep(rim, -rim, d);
    }
  });
  return bounds.empty() ? cv::Rect() : bounds;
}

}  // namespace freshet::synth::simulate
