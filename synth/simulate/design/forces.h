// synth/simulate/design/forces.h — what drives a design's fluid: weight, heat, still air, and the forces it asks for.
#pragma once

#include <vector>

#include "synth/simulate/design/stage.h"

namespace freshet::synth::simulate {

/// What is in the cells of the flow.
struct CellContents {
  const VectorGrid& velocity;  // cells per step
  const Grid& density;         // mean of each cell
  const Grid& heat;
};

/// Weight, buoyancy and drag on every cell: force is overwritten, cells per step per step.
void set_body_forces(const FluidOptions& fluid, const Stage& stage, const CellContents& cells,
                     VectorGrid& force);

/// 1 / density of what is in each cell, 1 the lightest: heavy fluid keeps its way through air that gives way.
void set_lightness(const FluidOptions& fluid, const Grid& density, Grid& lightness);

/// The forces of a design.
class Forces {
 public:
  /// phases  by force: where in the noise each reads. The forces are borrowed.
  Forces(const std::vector<Force>& forces, std::vector<float> phases, const Stage& stage);

  /// Adds those that hold now, cells per step per step.
  void add(const Stage& stage, const CellContents& cells, VectorGrid& force);

 private:
  void add_turbulence(const Force& turbulence, float phase, const Stage& stage, const Grid& density,
                      VectorGrid& force);

  const std::vector<Force>& forces_;
  std::vector<float> phases_;
  Grid stream_;  // of turbulence, at the cells' corners
};

}  // namespace freshet::synth::simulate
