// synth/simulate/solver/stable_fluids.cc
#include "synth/simulate/solver/stable_fluids.h"

#include <algorithm>
#include <cmath>

namespace freshet::synth::simulate {
namespace {

/// Into -limit..limit; what is not a number becomes 0.
float bounded(float x, float limit) {
  if (!(x == x)) return 0.0f;
  return x < limit ? (x > -limit ? x : -limit) : limit;
}

/// 1 where fluid may pass.
void set_faces(const StableFluidsOptions& options, const GridOf<std::uint8_t>& solid, Grid& fx, Grid& fy) {
  const int width = fy.width, height = fx.height;
  std::fill(fx.values.begin(), fx.values.end(), 1.0f);
  std::fill(fy.values.begin(), fy.values.end(), 1.0f);
  for (int y = 0; y < height; ++y) {
    if (options.left == Edge::kFixed) fx(0, y) = 0.0f;
    if (options.right == Edge::kFixed) fx(width, y) = 0.0f;
  }
  for (int x = 0; x < width; ++x) {
    if (options.top == Edge::kFixed) fy(x, 0) = 0.0f;
    if (options.bottom == Edge::kFixed) fy(x, height) = 0.0f;
  }
  if (solid.values.empty()) return;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (solid(x, y) == 0) continue;
      fx(x, y) = fx(x + 1, y) = fy(x, y) = fy(x, y + 1) = 0.0f;
    }
  }
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
      face_x_(u_),
      face_y_(v_),
      weight_x_(u_),
      weight_y_(v_),
      vorticity_(width, height),
      centred_(width, height),
      push_(width, height),
      backtrace_(width, height),
      projection_([&] {
        set_faces(options, solid, face_x_, face_y_);
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

void StableFluids::set_solid(const GridOf<std::uint8_t>& solid, const VectorGrid& velocity) {
  set_faces(options_, solid, face_x_, face_y_);
  const float limit = options_.max_speed;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      if (solid(x, y) == 0) continue;
      const Vec2 v = velocity(x, y);
      u_(x, y) = u_(x + 1, y) = bounded(v.x, limit);
      v_(x, y) = v_(x, y + 1) = bounded(v.y, limit);
    }
  }
  // A wall at the rim stays where it is, whatever touches it.
  for (int y = 0; y < height_; ++y) {
    if (options_.left == Edge::kFixed) u_(0, y) = 0.0f;
    if (options_.right == Edge::kFixed) u_(width_, y) = 0.0f;
  }
  for (int x = 0; x < width_; ++x) {
    if (options_.top == Edge::kFixed) v_(x, 0) = 0.0f;
    if (options_.bottom == Edge::kFixed) v_(x, height_) = 0.0f;
  }
  projection_.reset(face_x_, face_y_);
}

void StableFluids::set_lightness(const Grid& lightness) {
  for_rows(height_, [&](int y) {
    for (int x = 0; x <= width_; ++x) {
      weight_x_(x, y) =
          face_x_(x, y) * 0.5f * (lightness(std::max(x - 1, 0), y) + lightness(std::min(x, width_ - 1), y));
    }
  });
  for_rows(height_ + 1, [&](int y) {
    for (int x = 0; x < width_; ++x) {
      weight_y_(x, y) =
          face_y_(x, y) * 0.5f * (lightness(x, std::max(y - 1, 0)) + lightness(x, std::min(y, height_ - 1)));
    }
  });
  projection_.reset(weight_x_, weight_y_);
}

void StableFluids::push(const VectorGrid& force) {
  const float limit = options_.max_speed;
  for_rows(height_, [&](int y) {
    for (int x = 0; x < width_; ++x)
      push_(x, y) = {bounded(force(x, y).x, limit), bounded(force(x, y).y, limit)};
  });
  add_to_faces(1.0f);
}

ProjectionReport StableFluids::step(const VectorGrid* force, const Grid* source) {
  advect_velocity();
  confine(force);
  add_to_faces(1.0f - options_.damping);
  diffuse();
  const ProjectionReport report = projection_.apply(u_, v_, options_.projection, source);
  centre();
  return report;
}

void StableFluids::confine(const VectorGrid* force) {
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
      const Vec2 given = force != nullptr ? (*force)(x, y) : Vec2{};
      push_(x, y) = {bounded(given.x + scale * gy, limit), bounded(given.y - scale * gx, limit)};
    }
  });
}

void StableFluids::add_to_faces(float kept) {
  const float limit = options_.max_speed;
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

void StableFluids::diffuse() {
  if (!(options_.viscosity > 0.0f)) return;
  // A fifth of a cell^2 a sweep is stable, and damps what alternates from cell to cell.
  const int sweeps = static_cast<int>(options_.viscosity * 5.0f) + 1;
  const float fraction = options_.viscosity / static_cast<float>(sweeps);
  const auto sweep = [&](Grid& now, Grid& next, const Grid& face) {
    for_rows(now.height, [&](int y) {
      const int above = std::max(y - 1, 0), below = std::min(y + 1, now.height - 1);
      for (int x = 0; x < now.width; ++x) {
        const int left = std::max(x - 1, 0), right = std::min(x + 1, now.width - 1);
        const float here = now(x, y);
        const float around = now(left, y) + now(right, y) + now(x, above) + now(x, below);
        next(x, y) = face(x, y) > 0.0f ? here + fraction * (around - 4.0f * here) : here;
      }
    });
    std::swap(now, next);
  };
  for (int i = 0; i < sweeps; ++i) sweep(u_, next_u_, face_x_), sweep(v_, next_v_, face_y_);
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
