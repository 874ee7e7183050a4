// synth/simulate/solver/shallow_water.h — long waves over a bed: they steepen, break, run up a beach and drain off it.
#pragma once

#include "synth/field/grid.h"

namespace freshet::synth::simulate {

/// The shallow-water equations, depth and mean velocity in each cell, by finite volumes of the first order with
/// Rusanov's flux (LeVeque 2002). Beds are taken in by hydrostatic reconstruction (Audusse et al. 2004): water at rest
/// stays at rest over any bed, no depth falls below 0, and shores come and go by themselves. A breaking wave is a
/// shock, which takes out its energy. Nothing disperses: short waves go as fast as long ones.
///
/// Lengths in one unit, of the caller's choice; times in seconds. Water leaves and enters freely at all borders.
class ShallowWater {
 public:
  struct Options {
    float cell = 0.05f;      // side of a cell
    float gravity = 2.0f;    // per s^2
    float friction = 0.01f;  // of the bed: drag is friction * speed^2
  };

  /// bed   height above the level that still water has; the water lies at that level.
  ShallowWater(Grid bed, const Options& options);

  /// One step, no longer than longest_step(). Cost: some 90 operations a cell.
  void step(float seconds);
  /// By the fastest wave that is there now, s.
  float longest_step() const;

  const Grid& bed() const { return bed_; }
  const Grid& depth() const { return depth_; }              // 0 where it is dry
  const VectorGrid& velocity() const { return velocity_; }  // 0 where it is dry
  /// Moves a cell's surface (above the still level) and velocity towards these by a share, 0 to 1: how waves are made.
  void pull(int x, int y, float surface, Vec2 velocity, float share);

  /// Less than this is dry, cells: too thin a film to flow.
  float thinnest() const { return 0.02f * options_.cell; }

 private:
  Options options_;
  Grid bed_, depth_, next_depth_;
  VectorGrid velocity_, next_velocity_;
};

}  // namespace freshet::synth::simulate
