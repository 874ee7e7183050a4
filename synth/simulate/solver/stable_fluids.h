// synth/simulate/solver/stable_fluids.h — an incompressible flow that no time step can blow up.
#pragma once

#include <cstdint>
#include <vector>

#include "synth/field/grid.h"
#include "synth/simulate/solver/projection.h"

namespace freshet::synth::simulate {

enum class Edge {
  kOpen,   // still air outside: fluid may come and go
  kFixed,  // the velocity through it stays as set: a wall (0) or an inflow
};

struct StableFluidsOptions {
  Edge left = Edge::kOpen, right = Edge::kOpen, top = Edge::kOpen, bottom = Edge::kOpen;
  /// Vorticity confinement (Fedkiw, Stam, Jensen 2001), cells; 0: none. Above 0.5: noise.
  float confinement = 0.1f;
  float damping = 0.0f;     // fraction of the velocity lost per frame
  float viscosity = 0.0f;   // cells^2 per frame; solved in explicit sweeps, 5 for each unit
  float max_speed = 24.0f;  // cells per frame; forces cannot push beyond it
  ProjectionOptions projection{};
};

/// The velocity on a staggered grid (u on vertical faces, v on horizontal ones) and its solver after Stam
/// 1999: add trace back, add forces, project. One step is one frame.
///
/// Velocity is read back with a limited cubic in place of Stam's linear interpolation: one pass instead of
/// MacCormack's two, as little smoothing, no new extremes. Speeds and positions are bounded at every step, so
/// no force, however absurd, makes a value that is not finite.
class StableFluids {
 public:
  /// width, height  cells, at least 4.
  /// solid          1 in cells that the fluid cannot enter; empty: none.
  StableFluids(int width, int height, const StableFluidsOptions& options,
               const GridOf<std::uint8_t>& solid = {});

  /// Prescribes the velocity through the left edge and fills the field with it; Edge::kFixed keeps it.
  void set_inflow_left(const std::vector<float>& speed_by_row);

  /// Other obstacles, of the constructor's kind.
  /// velocity   theirs, a vector per cell, cells per frame: what touches a face of one takes its velocity
  ///            through it.
  void set_solid(const GridOf<std::uint8_t>& solid, const VectorGrid& velocity);

  /// lightness  1 / density of what is in each cell, (0, 1], 1 the lightest: pressure moves heavy cells less.
  ///            Until the next set_solid or set_lightness.
  void set_lightness(const Grid& lightness);

  /// Adds a force (a vector per cell, cells per frame per frame) at once, before the next step carries
  /// anything. What follows from velocity(), as drag does, belongs here: in step() it would meet what another
  /// cell had sent by then, and gusts of one cell would grow in every step.
  void push(const VectorGrid& force);

  /// force   acts on what has been carried; null: none.
  /// source  growth of the fluid's area, 1/frame, a value per cell; null: none.
  ProjectionReport step(const VectorGrid* force = nullptr, const Grid* source = nullptr);

  int width() const { return width_; }
  int height() const { return height_; }
  const VectorGrid& velocity() const { return centred_; }  // at cell centres, cells per frame
  /// Where a cell's content was one frame ago, less its place.
  const VectorGrid& backtrace() const { return backtrace_; }
  const Grid& u() const { return u_; }
  const Grid& v() const { return v_; }
  const Grid& face_x() const { return face_x_; }
  const Grid& face_y() const { return face_y_; }

 private:
  void confine(const VectorGrid* force);
  void add_to_faces(float kept);
  void advect_velocity();
  void diffuse();
  void centre();

  int width_, height_;
  StableFluidsOptions options_;
  Grid u_, v_, next_u_, next_v_;
  Grid face_x_, face_y_, weight_x_, weight_y_;
  Grid vorticity_;
  VectorGrid centred_, push_, backtrace_;
  Projection projection_;
};

}  // namespace freshet::synth::simulate
