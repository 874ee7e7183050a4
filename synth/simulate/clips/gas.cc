// synth/simulate/clips/gas.cc
#include "synth/simulate/clips/gas.h"

#include <algorithm>
#include <cmath>

namespace freshet::synth::simulate {
namespace {

/// 320 x 180 cells or so, whatever the picture: the flow's look, and most of its cost, stay the same.
int cell_step(cv::Size picture) { return std::clamp(std::min(picture.width, picture.height) / 180, 1, 16); }

}  // namespace

Domain::Domain(const SceneOptions& options, float margin_x, float margin_top, float margin_bottom)
    : picture(options.size), step(cell_step(options.size)) {
  const cv::Size size = picture;
  const auto margin = [&](float fraction, int side) {
    return static_cast<int>(fraction * static_cast<float>(side)) / step * step;
  };
  left = margin(margin_x, size.width);
  top = margin(margin_top, size.height);
  width = std::max(8, (size.width + 2 * left + step - 1) / step);
  height = std::max(8, (size.height + top + margin(margin_bottom, size.height) + step - 1) / step);
  scale = options.variation.zoom * static_cast<float>(std::min(size.width, size.height)) / 360.0f;
}

Gas::Gas(const Domain& where, float nearness, const StableFluidsOptions& options, int field_count,
         int texture_life, const GridOf<std::uint8_t>& solid)
    : domain(where),
      zoom(nearness),
      flow(where.width, where.height, options, solid),
      texture(where.width, where.height, texture_life, texture_life / 3),
      fields(static_cast<std::size_t>(field_count), Grid(where.fine_width(), where.fine_height())),
      force(where.width, where.height),
      scratch_(where.fine_width(), where.fine_height()),
      stream_(where.width + 1, where.height + 1) {}

void Gas::advance(Edges edges) {
  flow.step(&force);
  texture.advance(flow.backtrace());
  const VectorGrid& back = flow.backtrace();
  const float step = static_cast<float>(domain.step);
  for (Grid& field : fields) {
    for_rows(field.height, [&](int y) {
      float* out = scratch_.row(y);
      const float cy = domain.cell_from_fine(static_cast<float>(y));
      for (int x = 0; x < field.width; ++x) {
        const Vec2 d = bilinear(back, domain.cell_from_fine(static_cast<float>(x)), cy);
        const float from_x = static_cast<float>(x) + step * d.x, from_y = static_cast<float>(y) + step * d.y;
        out[x] =
            edges == Edges::kSharp ? bicubic_limited(field, from_x, from_y) : bilinear(field, from_x, from_y);
      }
    });
    std::swap(field, scratch_);
  }
}

void Gas::stir(const Noise& noise, float time, float size_cells, float strength, const Grid& amount) {
  size_cells *= zoom;
  const float pitch = 1.0f / size_cells;
  for_rows(stream_.height, [&](int y) {
    for (int x = 0; x < stream_.width; ++x) {
      stream_(x, y) =
          noise.changing(static_cast<float>(x) * pitch, static_cast<float>(y) * pitch, time, 2, 0.5f);
    }
  });
  const float scale = strength * size_cells;
  for_rows(force.height, [&](int y) {
    for (int x = 0; x < force.width; ++x) {
      const float a = amount(x, y) * scale;
      if (a <= 0.0f) continue;
      force(x, y).x += a * (stream_(x, y + 1) - stream_(x, y));
      force(x, y).y -= a * (stream_(x + 1, y) - stream_(x, y));
    }
  });
}

void Gas::hold_back(float terminal, float push) {
  const float scale = push / (terminal * terminal);
  for_rows(force.height, [&](int y) {
    for (int x = 0; x < force.width; ++x) {
      const Vec2 v = flow.velocity()(x, y);
      const float drag = std::min(0.5f, scale * std::sqrt(v.x * v.x + v.y * v.y));
      force(x, y).x -= drag * v.x;
      force(x, y).y -= drag * v.y;
    }
  });
}

void Gas::reduce(const Grid& field, Grid& cells) const {
  const float fraction = 1.0f / static_cast<float>(domain.step * domain.step);
  for_rows(cells.height, [&](int y) {
    for (int x = 0; x < cells.width; ++x) {
      float sum = 0.0f;
      for (int j = 0; j < domain.step; ++j) {
        const float* p = field.row(y * domain.step + j) + x * domain.step;
        for (int i = 0; i < domain.step; ++i) sum += p[i];
      }
      cells(x, y) = sum * fraction;
    }
  });
}

Vec2 Gas::motion_at(int x, int y) const {
  const Vec2 v = bilinear(flow.velocity(), domain.cell_from_fine(static_cast<float>(x + domain.left)),
                          domain.cell_from_fine(static_cast<float>(y + domain.top)));
  const float step = static_cast<float>(domain.step);
  return {v.x * step, v.y * step};
}

}  // namespace freshet::synth::simulate
