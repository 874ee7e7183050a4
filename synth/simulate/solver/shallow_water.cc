// synth/simulate/solver/shallow_water.cc
#include "synth/simulate/solver/shallow_water.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace freshet::synth::simulate {
namespace {

/// A cell as one of its sides sees it: `along` is the velocity through that side, `across` the other.
struct Cell {
  float depth, along, across, bed;
};

/// What goes through a side between two cells, towards the second, a second and a unit of length; the push of the bed
/// on either is in that cell's own momentum.
struct Flux {
  float mass, along_first, along_second, across;
};

Flux flux(const Cell& a, const Cell& b, float gravity) {
  const float sill = std::max(a.bed, b.bed);
  const float da = std::max(0.0f, a.depth + a.bed - sill), db = std::max(0.0f, b.depth + b.bed - sill);
  const float fastest =
      std::max(std::fabs(a.along) + std::sqrt(gravity * da), std::fabs(b.along) + std::sqrt(gravity * db));
  const float qa = da * a.along, qb = db * b.along;
  const float mass = 0.5f * (qa + qb - fastest * (db - da));
  const float along =
      0.5f * (qa * a.along + qb * b.along + 0.5f * gravity * (da * da + db * db) - fastest * (qb - qa));
  const float across = 0.5f * (qa * a.across + qb * b.across - fastest * (db * b.across - da * a.across));
  return {mass, along + 0.5f * gravity * (a.depth * a.depth - da * da),
          along + 0.5f * gravity * (b.depth * b.depth - db * db), across};
}

}  // namespace

ShallowWater::ShallowWater(Grid bed, const Options& options)
    : options_(options),
      bed_(std::move(bed)),
      depth_(bed_.width, bed_.height),
      next_depth_(depth_),
      velocity_(bed_.width, bed_.height),
      next_velocity_(velocity_) {
  for (std::size_t i = 0; i < bed_.values.size(); ++i) depth_.values[i] = std::max(0.0f, -bed_.values[i]);
}

float ShallowWater::longest_step() const {
  float fastest = 1e-3f;
  for (std::size_t i = 0; i < depth_.values.size(); ++i) {
    const Vec2 v = velocity_.values[i];
    fastest = std::max(
        fastest, std::max(std::fabs(v.x), std::fabs(v.y)) + std::sqrt(options_.gravity * depth_.values[i]));
  }
  return 0.45f * options_.cell / fastest;  // half is the limit where depths stay above 0
}

void ShallowWater::step(float seconds) {
  const int last_x = depth_.width - 1, last_y = depth_.height - 1;
  const float per_cell = seconds / options_.cell, thinnest = this->thinnest();
  for_rows(depth_.height, [&](int y) {
    const auto seen = [&](int cx, int cy) -> Cell {
      const Vec2 v = velocity_(cx, cy);
      return {depth_(cx, cy), v.x, v.y, bed_(cx, cy)};
    };
    const auto turned = [](Cell cell) -> Cell { return {cell.depth, cell.across, cell.along, cell.bed}; };
    const int above = std::max(y - 1, 0), below = std::min(y + 1, last_y);
    Cell here = seen(0, y);
    Flux from_left = flux(here, here, options_.gravity);
    for (int x = 0; x <= last_x; ++x) {
      const Cell right = seen(std::min(x + 1, last_x), y);
      const Flux to_right = flux(here, right, options_.gravity);
      const Flux from_above = flux(turned(seen(x, above)), turned(here), options_.gravity);
      const Flux to_below = flux(turned(here), turned(seen(x, below)), options_.gravity);
      const float depth = std::max(
          0.0f, here.depth - per_cell * (to_right.mass - from_left.mass + to_below.mass - from_above.mass));
      const float qx = here.depth * here.along - per_cell * (to_right.along_first - from_left.along_second +
                                                             to_below.across - from_above.across);
      const float qy = here.depth * here.across - per_cell * (to_right.across - from_left.across +
                                                              to_below.along_first - from_above.along_second);
      Vec2 v{};
      if (depth > thinnest) {
        v = {qx / depth, qy / depth};
        const float kept =
            1.0f / (1.0f + seconds * options_.friction * std::sqrt(v.x * v.x + v.y * v.y) / depth);
        v = {v.x * kept, v.y * kept};
      }
      next_depth_(x, y) = depth, next_velocity_(x, y) = v;
      here = right, from_left = to_right;
    }
  });
  std::swap(depth_, next_depth_), std::swap(velocity_, next_velocity_);
}

void ShallowWater::pull(int x, int y, float surface, Vec2 velocity, float share) {
  float& depth = depth_(x, y);
  Vec2& v = velocity_(x, y);
  depth += share * (std::max(0.0f, surface - bed_(x, y)) - depth);
  v = {v.x + share * (velocity.x - v.x), v.y + share * (velocity.y - v.y)};
}

}  // namespace freshet::synth::simulate
