// synth/simulate/design/carried_fluid.h — what a design's flow carries: density by pixels, heat by cells.
#pragma once

#include <opencv2/core.hpp>

#include "synth/simulate/scene/design.h"

namespace freshet::synth::simulate {

class CarriedFluid {
 public:
  /// None yet.
  CarriedFluid(cv::Size picture, cv::Size cells);

  /// velocity  of the picture's size, px per step. Fluid is lost and burnt on the way, and clear air comes in
  ///           through open sides.
  void carry_density(const Design& design, float step_s, const VectorGrid& velocity);
  /// backtrace  where a cell's content was one step ago, less its place (StableFluids::backtrace).
  void carry_heat(const FluidOptions& fluid, float step_s, const VectorGrid& backtrace);

  Grid density;  // of the picture's pixels
  Grid heat;     // of cells

 private:
  Grid next_density_, next_heat_;
};

/// Where the content of each pixel has come after one more step. velocity: px per step; displacement: px from the
/// pixel, changed in place.
void carry_points(const VectorGrid& velocity, VectorGrid& displacement);

}  // namespace freshet::synth::simulate
