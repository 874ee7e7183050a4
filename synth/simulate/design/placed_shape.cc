#include "synth/simulate/design/placed_shape.h"

#include <algorithm>
#include <cstdint>

#include "synth/simulate/design/shape.h"

namespace freshet::synth::simulate {

PlacedShape::PlacedShape(const Shape& shape, cv::Size picture, cv::Size cells)
    : shape_(&shape), coverage_(picture.width, picture.height), cells_(cells.width, cells.height) {}

bool PlacedShape::place(double time_s) {
  const Vec2 shift = shift_at(*shape_, time_s);
  if (shift.x == shift_.x && shift.y == shift_.y) return false;
  shift_ = shift;
  bounds_ = draw_shape(*shape_, shift, coverage_);
  std::fill(cells_.values.begin(), cells_.values.end(), 0.0f);
  cell_means(coverage_, bounds_, cells_);
  return true;
}

void cell_means(const Grid& field, cv::Rect bounds, Grid& cells) {
  const auto first = [](int cell, int count, int pixels) {
    return static_cast<int>(static_cast<std::int64_t>(cell) * pixels / count);
  };
  for_rows(cells.height, [&](int y) {
    const int y0 = first(y, cells.height, field.height),
              y1 = std::max(y0 + 1, first(y + 1, cells.height, field.height));
    if (y1 <= bounds.y || y0 >= bounds.y + bounds.height) return;
    for (int x = 0; x < cells.width; ++x) {
      const int x0 = first(x, cells.width, field.width),
                x1 = std::max(x0 + 1, first(x + 1, cells.width, field.width));
      if (x1 <= bounds.x || x0 >= bounds.x + bounds.width) continue;
      float sum = 0.0f;
      for (int j = y0; j < y1; ++j) {
        const float* p = field.row(j);
        for (int i = x0; i < x1; ++i) sum += p[i];
      }
      cells(x, y) = sum / static_cast<float>((y1 - y0) * (x1 - x0));
    }
  });
}

}  // namespace freshet::synth::simulate
