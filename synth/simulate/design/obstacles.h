// synth/simulate/design/obstacles.h — what stands in a design's way, and how it moves.
#pragma once

#include <cstdint>
#include <vector>

#include "synth/simulate/design/placed_shape.h"
#include "synth/simulate/design/stage.h"
#include "synth/simulate/solver/stable_fluids.h"

namespace freshet::synth::simulate {

class Obstacles {
 public:
  /// The obstacles are borrowed.
  Obstacles(const std::vector<Obstacle>& obstacles, const Stage& stage);

  /// Moves them to where they are now, and tells the flow when anything has changed.
  void place(const Stage& stage, StableFluids& flow);
  /// Takes away what lies where they are.
  void clear(Grid& density) const;

  const Grid& coverage() const { return coverage_; }            // of the picture, 0..1
  const GridOf<std::uint8_t>& solid() const { return solid_; }  // 1 in cells that are mostly obstacle

 private:
  void set(const Stage& stage);

  const std::vector<Obstacle>& obstacles_;
  std::vector<PlacedShape> placed_;
  Grid coverage_;
  GridOf<std::uint8_t> solid_;
  VectorGrid velocity_;  // of solid cells, cells per step
  bool set_once_ = false;
};

}  // namespace freshet::synth::simulate
