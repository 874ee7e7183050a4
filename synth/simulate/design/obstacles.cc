#include "synth/simulate/design/obstacles.h"

#include <algorithm>

#include "synth/simulate/design/shape.h"

namespace freshet::synth::simulate {

Obstacles::Obstacles(const std::vector<Obstacle>& obstacles, const Stage& stage)
    : obstacles_(obstacles),
      coverage_(stage.picture.width, stage.picture.height),
      solid_(stage.cells.width, stage.cells.height),
      velocity_(stage.cells.width, stage.cells.height) {
  for (const Obstacle& obstacle : obstacles) placed_.emplace_back(obstacle.shape, stage.picture, stage.cells);
}

void Obstacles::place(const Stage& stage, StableFluids& flow) {
  if (placed_.empty()) return;
  bool changed = !set_once_;
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    changed |= placed_[i].place(stage.clock_s);
    const Span& span = obstacles_[i].span;
    const bool there = span.holds(stage.clock_s);
    const bool was = set_once_ && span.holds(stage.clock_s - stage.step_s);
    // One more step after it came to rest, to take its velocity away.
    changed |= there != was || !placed_[i].shape().move.empty();
  }
  set_once_ = true;
  if (!changed) return;
  set(stage);
  flow.set_solid(solid_, velocity_);
}

void Obstacles::set(const Stage& stage) {
  std::fill(coverage_.values.begin(), coverage_.values.end(), 0.0f);
  std::fill(solid_.values.begin(), solid_.values.end(), std::uint8_t{0});
  std::fill(velocity_.values.begin(), velocity_.values.end(), Vec2{});
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    if (!obstacles_[i].span.holds(stage.clock_s)) continue;
    const PlacedShape& placed = placed_[i];
    const Vec2 before = shift_at(placed.shape(), stage.clock_s - stage.step_s);
    const Vec2 speed{(placed.shift().x - before.x) * static_cast<float>(stage.cells.width),
                     (placed.shift().y - before.y) * static_cast<float>(stage.cells.height)};
    for (std::size_t k = 0; k < solid_.values.size(); ++k) {
      if (placed.cell_coverage().values[k] < 0.5f) continue;
      solid_.values[k] = 1;
      velocity_.values[k] = speed;
    }
    const cv::Rect& b = placed.bounds();
    for (int y = b.y; y < b.y + b.height; ++y) {
      for (int x = b.x; x < b.x + b.width; ++x)
        coverage_(x, y) = std::max(coverage_(x, y), placed.coverage()(x, y));
    }
  }
}

void Obstacles::clear(Grid& density) const {
  if (placed_.empty()) return;
  for_rows(density.height, [&](int y) {
    const float* solid = coverage_.row(y);
    float* p = density.row(y);
    for (int x = 0; x < density.width; ++x) p[x] *= 1.0f - solid[x];
  });
}

}  // namespace freshet::synth::simulate
