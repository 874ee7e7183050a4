// synth/simulate/design/fine_velocity.h — the velocity of coarse cells, read at every pixel.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "synth/field/grid.h"

namespace freshet::synth::simulate {

/// Catmull-Rom between the faces of the staggered grid. Linear reading has kinks along the cells' edges,
/// which show as a lattice once fluid has been drawn out over many frames; the normal velocity at a closed
/// side is exactly 0, so that nothing leaves through it.
class FineVelocity {
 public:
  /// cells, picture  both cover the same area, with any ratio of sizes.
  FineVelocity(cv::Size cells, cv::Size picture);

  /// u: (cells.width + 1) x cells.height, v: cells.width x (cells.height + 1), cells per step.
  /// velocity  of the picture's size, px per step, at the pixels' centres; overwritten.
  /// Cost  O(pixels).
  void read(const Grid& u, const Grid& v, VectorGrid& velocity);

 private:
  struct CubicTap {
    int index[4];
    float weight[4];
  };
  static std::vector<CubicTap> taps(int samples, int cells, int pixels, float first);
  void widen(const Grid& in, const std::vector<CubicTap>& across, Grid& out) const;

  float px_per_cell_x_, px_per_cell_y_;
  std::vector<CubicTap> u_across_, u_down_, v_across_, v_down_;
  Grid wide_u_, wide_v_;
};

}  // namespace freshet::synth::simulate
