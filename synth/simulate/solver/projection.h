// synth/simulate/solver/projection.h — the pressure that takes the divergence out of a velocity field.
#pragma once

#include <cstdint>
#include <memory>

#include "synth/field/grid.h"

namespace freshet::synth::simulate {

struct ProjectionOptions {
  double max_divergence = 2e-3;  // root of the mean square, 1/frame; iteration stops below it
  int max_iterations = 12;       // of the conjugate gradients, each with one multigrid cycle
};
struct ProjectionReport {
  int iterations = 0;
  /// Root mean square over cells that are not solid, 1/frame.
  double divergence_before = 0.0, divergence_after = 0.0;
};

/// Makes velocity fields free of divergence.
///
/// face_x   faces between cells: (width + 1) x height. 1 where fluid may pass, 0 at a wall or where the
///          velocity is prescribed. Between them where heavy fluid lies: how far pressure moves it. A
///          passable face on the rim leads to open air of pressure 0.
/// face_y   width x (height + 1), likewise.
///
///
/// Conjugate gradients preconditioned by one multigrid V-cycle (McAdams, Sifakis, Teran 2010): plain
/// multigrid alone stalls around small obstacles. Coarse cells gather 2 x 2 fine ones; red-black Gauss-Seidel
/// before and, in reverse order, after, so that the preconditioner is symmetric. Sums run in double, row by
/// row, in row order: the same bits for any number of threads.
class Projection {
 public:
  Projection(const Grid& face_x, const Grid& face_y);
  /// Other faces of the same size: obstacles move. Allocates nothing.
  void reset(const Grid& face_x, const Grid& face_y);
  Projection(Projection&&) noexcept;
  ~Projection();

  /// Makes (u, v) free of divergence: u on face_x's points, v on face_y's, cells per frame. Faces of weight 0
  /// keep their velocity. The pressure found last is the first guess of the next call.
  /// source  the divergence that is to remain, 1/frame, a value per cell; null: none. The report counts what
  ///         differs from it.
  ProjectionReport apply(Grid& u, Grid& v, const ProjectionOptions& options = {},
                         const Grid* source = nullptr);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Root mean square of the divergence over the cells with a passable face, 1/frame.
/// What `source` asks for is taken off.
double divergence(const Grid& u, const Grid& v, const Grid& face_x, const Grid& face_y,
                  const Grid* source = nullptr);

}  // namespace freshet::synth::simulate
