#include "synth/simulate/design/carried_fluid.h"

#include <algorithm>
#include <utility>

namespace freshet::synth::simulate {

CarriedFluid::CarriedFluid(cv::Size picture, cv::Size cells)
    : density(picture.width, picture.height),
      heat(cells.width, cells.height),
      next_density_(density),
      next_heat_(heat) {}

void CarriedFluid::carry_density(const Design& design, float step_s, const VectorGrid& velocity) {
  const FluidOptions& f = design.fluid;
  const float kept = std::max(0.0f, 1.0f - f.dissipation * step_s), burnt = f.burning * step_s;
  const float last_x = static_cast<float>(density.width - 1), last_y = static_cast<float>(density.height - 1);
  for_rows(density.height, [&](int y) {
    const Vec2* v = velocity.row(y);
    float* out = next_density_.row(y);
    for (int x = 0; x < density.width; ++x) {
      const float px = static_cast<float>(x), py = static_cast<float>(y);
      const Vec2 half = bilinear(velocity, px - 0.5f * v[x].x, py - 0.5f * v[x].y);
      const float from_x = px - half.x, from_y = py - half.y;
      float value = bicubic_limited(density, from_x, from_y);
      // Clear air comes in through open sides.
      if (design.left == Side::kOpen) value *= std::clamp(1.0f + from_x, 0.0f, 1.0f);
      if (design.right == Side::kOpen) value *= std::clamp(1.0f + last_x - from_x, 0.0f, 1.0f);
      if (design.top == Side::kOpen) value *= std::clamp(1.0f + from_y, 0.0f, 1.0f);
      if (design.bottom == Side::kOpen) value *= std::clamp(1.0f + last_y - from_y, 0.0f, 1.0f);
      out[x] = std::max(0.0f, value * kept - burnt);
    }
  });
  std::swap(density, next_density_);
}

void CarriedFluid::carry_heat(const FluidOptions& fluid, float step_s, const VectorGrid& backtrace) {
  const float kept = std::max(0.0f, 1.0f - fluid.cooling * step_s);
  for_rows(heat.height, [&](int y) {
    for (int x = 0; x < heat.width; ++x) {
      const Vec2 back = backtrace(x, y);
      next_heat_(x, y) =
          kept * bicubic_limited(heat, static_cast<float>(x) + back.x, static_cast<float>(y) + back.y);
    }
  });
  std::swap(heat, next_heat_);
}

void carry_points(const VectorGrid& velocity, VectorGrid& displacement) {
  for_rows(velocity.height, [&](int y) {
    Vec2* c = displacement.row(y);
    for (int x = 0; x < velocity.width; ++x) {
      const float at_x = static_cast<float>(x) + c[x].x, at_y = static_cast<float>(y) + c[x].y;
      const Vec2 v = bilinear(velocity, at_x, at_y);
      const Vec2 half = bilinear(velocity, at_x + 0.5f * v.x, at_y + 0.5f * v.y);
      c[x] = {c[x].x + half.x, c[x].y + half.y};
    }
  });
}

}  // namespace freshet::synth::simulate
