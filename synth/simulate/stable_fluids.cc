// synth/simulate/stable_fluids.cc
#include "synth/simulate/stable_fluids.h"

#include <algorithm>
#include <cmath>

namespace freshet::synth::simulate {
namespace {

/// Into -limit..limit; what is not a number becomes 0.
float bounded(float x, float limit) {
  if (!(x == x)) return 0.0f;
  return x < limit ? (x > -limit ? x : -limit) : limit;
}

struct Faces {
  Grid x, y;
};
Faces passable_faces(int width, int height, const StableFluidsOptions& options,
                     const GridOf<std::uint8_t>& solid) {
  Faces faces{Grid(width + 1, height, 1.0f), Grid(width, height + 1, 1.0f)};
  for (int y = 0; y < height; ++y) {
    if (options.left == Edge::kFixed) faces.x(0, y) = 0.0f;
    if (options.right == Edge::kFixed) faces.x(width, y) = 0.0f;
  }
  for (int x = 0; x < width; ++x) {
    if (options.top == Edge::kFixed) faces.y(x, 0) = 0.0f;
    if (options.bottom == Edge::kFixed) faces.y(x, height) = 0.0f;
  }
  if (solid.values.empty()) return faces;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (solid(x, y) == 0) continue;
      faces.x(x, y) = faces.x(x + 1, y) = faces.y(x, y) = faces.y(x, y + 1) = 0.0f;
    }
  }
  return faces;
}

}  // namespace

StableFluids::StableFluids(int width, int height, const StableFluidsOptions& options,
                           const GridOf<std::uint8_t>& solid)
    : width_(width),
      height_(height),
      options_(options),
      u_(width + 1, height),
      v_(width, height + 1),
      next_u_(u_),
      next_v_(v_),
      vorticity_(width, height),
      centred_(width, height),
      push_(width, height),
      backtrace_(width, height),
      projection_([&] {
        Faces faces = passable_faces(width, height, options, solid);
        face_x_ = std::move(faces.x), face_y_ = std::move(faces.y);
        return Projection(face_x_, face_y_);
      }()) {}

void StableFluids::set_inflow_left(const std::vector<float>& speed_by_row) {
  for (int y = 0; y < height_; ++y) {
    const float speed = bounded(speed_by_row[static_cast<std::size_t>(y)], options_.max_speed);
    u_(0, y) = speed;
    for (int x = 1; x <= width_; ++x) u_(x, y) = face_x_(x, y) > 0.0f ? speed : 0.0f;
  }
  centre();
}

ProjectionReport StableFluids::step(const VectorGrid& force) {
  advect_velocity();
  add_forces(force);
  const ProjectionReport report = projection_.apply(u_, v_, options_.projection);
  centre();
  return report;
}

void StableFluids::add_forces(const VectorGrid& force) {
  for_rows(height_, [&](int y) {
    const int above = std::max(y - 1, 0), below = std::min(y + 1, height_ - 1);
    for (int x = 0; x < width_; ++x) {
      const int left = std::max(x - 1, 0), right = std::min(x + 1, width_ - 1);
      vorticity_(x, y) =
          0.5f * (centred_(right, y).y - centred_(left, y).y - centred_(x, below).x + centred_(x, above).x);
    }
  });
  for_rows(height_, [&](int y) {
    const int above = std::max(y - 1, 0), below = std::min(y + 1, height_ - 1);
    const float limit = options_.max_speed;
    for (int x = 0; x < width_; ++x) {
      const int left = std::max(x - 1, 0), right = std::min(x + 1, width_ - 1);
      const float gx = 0.5f * (std::fabs(vorticity_(right, y)) - std::fabs(vorticity_(left, y)));
      const float gy = 0.5f * (std::fabs(vorticity_(x, below)) - std::fabs(vorticity_(x, above)));
      const float scale = options_.confinement * vorticity_(x, y) / (std::sqrt(gx * gx + gy * gy) + 1e-4f);
      push_(x, y) = {bounded(force(x, y).x + scale * gy, limit), bounded(force(x, y).y - scale * gx, limit)};
    }
  });
  const float kept = 1.0f - options_.damping, limit = options_.max_speed;
  for_rows(height_, [&](int y) {
    for (int x = 0; x <= width_; ++x) {
      if (face_x_(x, y) <= 0.0f) continue;
      const float push = 0.5f * (push_(std::max(x - 1, 0), y).x + push_(std::min(x, width_ - 1), y).x);
      u_(x, y) = bounded(u_(x, y) * kept + push, limit);
    }
  });
  for_rows(height_ + 1, [&](int y) {
    for (int x = 0; x < width_; ++x) {
      if (face_y_(x, y) <= 0.0f) continue;
      const float push = 0.5f * (push_(x, std::max(y - 1, 0)).y + push_(x, std::min(y, height_ - 1)).y);
      v_(x, y) = bounded(v_(x, y) * kept + push, limit);
    }
  });
}

void StableFluids::centre() {
  for_rows(height_, [&](int y) {
    for (int x = 0; x < width_; ++x) {
      centred_(x, y) = {0.5f * (u_(x, y) + u_(x + 1, y)), 0.5f * (v_(x, y) + v_(x, y + 1))};
    }
  });
  // Midpoint rule: the velocity half a frame back along the way.
  for_rows(height_, [&](int y) {
    for (int x = 0; x < width_; ++x) {
      const Vec2 here = centred_(x, y);
      const Vec2 half =
          bilinear(centred_, static_cast<float>(x) - 0.5f * here.x, static_cast<float>(y) - 0.5f * here.y);
      backtrace_(x, y) = {-half.x, -half.y};
    }
  });
}

void StableFluids::advect_velocity() {
  for_rows(height_, [&](int y) {
    for (int x = 0; x <= width_; ++x) {
      const Vec2 back = bilinear(backtrace_, static_cast<float>(x) - 0.5f, static_cast<float>(y));
      next_u_(x, y) = face_x_(x, y) > 0.0f ? bicubic_limited(u_, static_cast<float>(x) + back.x,
                                                             static_cast<float>(y) + back.y)
                                           : u_(x, y);
    }
  });
  for_rows(height_ + 1, [&](int y) {
    for (int x = 0; x < width_; ++x) {
      const Vec2 back = bilinear(backtrace_, static_cast<float>(x), static_cast<float>(y) - 0.5f);
      next_v_(x, y) = face_y_(x, y) > 0.0f ? bicubic_limited(v_, static_cast<float>(x) + back.x,
                                                             static_cast<float>(y) + back.y)
                                           : v_(x, y);
    }
  });
  std::swap(u_, next_u_);
  std::swap(v_, next_v_);
}

}  // namespace freshet::synth::simulate
