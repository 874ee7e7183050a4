#include "synth/simulate/design/forces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "synth/field/portable_math.h"

namespace freshet::synth::simulate {
namespace {

// Cells per step per step, for 1 height/s^2.
float pull_of(const Stage& stage) { return stage.speed_unit() * stage.step_s; }

// Drags all air towards a velocity.
void add_wind(const Force& wind, const Stage& stage, const VectorGrid& velocity, VectorGrid& force) {
  const Vec2 asked{wind.velocity.x * stage.speed_unit(), wind.velocity.y * stage.speed_unit()};
  const float fraction = std::min(1.0f, wind.strength * stage.step_s);
  for_rows(force.height, [&](int y) {
    for (int x = 0; x < force.width; ++x) {
      const Vec2 v = velocity(x, y);
      force(x, y).x += fraction * (asked.x - v.x), force(x, y).y += fraction * (asked.y - v.y);
    }
  });
}

// Towards a place, or around it.
void add_around(const Force& around, const Stage& stage, VectorGrid& force) {
  const float rows = static_cast<float>(stage.cells.height);
  const Vec2 middle{around.position.x * static_cast<float>(stage.cells.width) - 0.5f,
                    around.position.y * rows - 0.5f};
  const float reach = around.radius * rows, strength = around.strength * pull_of(stage);
  const bool turns = around.kind == Force::Kind::kVortex;
  for_rows(force.height, [&](int y) {
    for (int x = 0; x < force.width; ++x) {
      const float dx = (static_cast<float>(x) - middle.x) / reach,
                  dy = (static_cast<float>(y) - middle.y) / reach;
      // r exp((1 - r^2) / 2): 0 in the middle, 1 at the radius.
      const float scale = strength * exp_portable(0.5f * (1.0f - dx * dx - dy * dy));
      force(x, y).x += turns ? scale * dy : -scale * dx;
      force(x, y).y += turns ? -scale * dx : -scale * dy;
    }
  });
}

}  // namespace

void set_body_forces(const FluidOptions& f, const Stage& stage, const CellContents& cells,
                     VectorGrid& force) {
  const float pull = pull_of(stage);
  const float still = std::min(1.0f, f.still_air * stage.step_s), light = 1.0f / f.weight;
  const float brake = f.top_speed > 0.0f
                          ? std::max(f.buoyancy, f.gravity) /
                                (f.top_speed * f.top_speed * static_cast<float>(stage.cells.height))
                          : 0.0f;
  for_rows(force.height, [&](int y) {
    for (int x = 0; x < force.width; ++x) {
      const Vec2 v = cells.velocity(x, y);
      const float thick = std::min(cells.density(x, y), 1.0f);
      const float drag = still * (1.0f - std::min(1.0f, 4.0f * thick)) +
                         std::min(0.5f, brake * std::sqrt(v.x * v.x + v.y * v.y));
      const float fall = f.gravity * thick / lerp(light, 1.0f, thick);  // the air in a cell weighs little
      force(x, y) = {-drag * v.x, pull * (fall - f.buoyancy * cells.heat(x, y)) - drag * v.y};
    }
  });
}

void set_lightness(const FluidOptions& fluid, const Grid& density, Grid& lightness) {
  const float light = 1.0f / fluid.weight;
  for_rows(density.height, [&](int y) {
    for (int x = 0; x < density.width; ++x)
      lightness(x, y) = light / lerp(light, 1.0f, std::min(density(x, y), 1.0f));
  });
}

Forces::Forces(const std::vector<Force>& forces, std::vector<float> phases, const Stage& stage)
    : forces_(forces), phases_(std::move(phases)), stream_(stage.cells.width + 1, stage.cells.height + 1) {}

void Forces::add(const Stage& stage, const CellContents& cells, VectorGrid& force) {
  for (std::size_t i = 0; i < forces_.size(); ++i) {
    if (!forces_[i].span.holds(stage.clock_s)) continue;
    switch (forces_[i].kind) {
      case Force::Kind::kWind:
        add_wind(forces_[i], stage, cells.velocity, force);
        break;
      case Force::Kind::kTurbulence:
        add_turbulence(forces_[i], phases_[i], stage, cells.density, force);
        break;
      case Force::Kind::kPoint:
      case Force::Kind::kVortex:
        add_around(forces_[i], stage, force);
        break;
    }
  }
}

// The curl of noise: it stirs, and neither gathers nor scatters.
void Forces::add_turbulence(const Force& turbulence, float phase, const Stage& stage, const Grid& density,
                            VectorGrid& force) {
  const float rows = static_cast<float>(stage.cells.height);
  const float pitch = 1.0f / (turbulence.size * rows), time = turbulence.change * stage.noise_time();
  for_rows(stream_.height, [&](int y) {
    for (int x = 0; x < stream_.width; ++x) {
      stream_(x, y) = stage.noise.changing(static_cast<float>(x) * pitch + phase,
                                           static_cast<float>(y) * pitch - phase, time, 2);
    }
  });
  const float scale = turbulence.strength * pull_of(stage) * turbulence.size * rows;
  for_rows(force.height, [&](int y) {
    for (int x = 0; x < force.width; ++x) {
      const float a = turbulence.in_fluid_only ? scale * std::min(1.0f, 3.0f * density(x, y)) : scale;
      force(x, y).x += a * (stream_(x, y + 1) - stream_(x, y));
      force(x, y).y -= a * (stream_(x + 1, y) - stream_(x, y));
    }
  });
}

}  // namespace freshet::synth::simulate
