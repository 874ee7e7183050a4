// synth/simulate/scene/design.h — a designed motion: what lets fluid in, what stops it, what drives it.
//
// Places are fractions of the picture: x of its width, y of its height, y down. Lengths are fractions of its
// height, speeds picture heights per second, times seconds from frame 0. So a design means the same at every
// size of picture, on every grid and at every rate of frames.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/field/grid.h"

namespace freshet::synth::simulate {

inline constexpr double kForever = std::numeric_limits<double>::infinity();

/// When something acts. Before frame 0 (the warm-up) time is negative.
struct Span {
  double from_s = -kForever, to_s = kForever;
  bool holds(double time_s) const { return time_s >= from_s && time_s < to_s; }
};

/// A place in the picture.
struct Shape {
  enum class Kind { kDisc, kLine, kPolygon, kPicture };
  Kind kind = Kind::kDisc;
  std::vector<Vec2> points{};  // disc: its centre; line: its ends; polygon: its corners, at least 3
  float radius = 0.05f;        // of a disc; half the width of a line
  float softness = 0.0f;       // how far the rim fades, outwards and inwards; at least a pixel
  cv::Mat picture{};           // CV_8U, white inside; laid over the whole picture
  /// (seconds, shift): how far the shape is moved over time, straight between; fractions of width and height.
  std::vector<std::pair<float, Vec2>> move{};
};

struct Emitter {
  std::string name;
  Shape shape;
  Span span;
  /// (seconds, density) that the shape is held filled with, straight between. Density 1 is one layer: alpha
  /// is 1 - exp(-opacity x density).
  std::vector<std::pair<float, float>> rate{{0.0f, 1.0f}};
  Vec2 velocity;           // that fluid comes out with, heights/s; (0, 0): it is not driven
  float heat = 0.0f;       // given to the fluid: what buoyancy acts on
  float expansion = 0.0f;  // growth of the fluid's area inside, a fraction per second: a blast
  float jitter = 0.3f;     // 0: even; 1: density and velocity come in gusts and lumps
  float lump = 0.05f;      // size of these lumps, heights
};

struct Obstacle {
  std::string name;
  Shape shape;
  Span span;
};

struct Force {
  enum class Kind { kWind, kPoint, kVortex, kTurbulence };
  Kind kind = Kind::kWind;
  Span span;
  Vec2 velocity;        // wind: drags all air towards it
  Vec2 position;        // point, vortex
  float radius = 0.2f;  // point, vortex: how far from the middle it is strongest
  float size = 0.1f;    // turbulence: of its eddies
  float change = 1.0f;  // turbulence: fresh patterns per second
  /// wind:        fraction of the difference made up per second.
  /// point:       heights/s^2, towards the place (below 0: away).
  /// vortex:      heights/s^2, anticlockwise as seen.
  /// turbulence:  heights/s^2.
  float strength = 1.0f;
  bool in_fluid_only = true;  // turbulence: nothing where there is no fluid
};

struct FluidOptions {
  float buoyancy = 0.0f;  // heights/s^2 upwards for heat 1
  float gravity = 0.0f;   // heights/s^2 downwards for density 1
  /// How many times heavier than air fluid of density 1 is: water falls as it is, a jet shoots through.
  float weight = 1.0f;
  float vorticity = 1.0f;    // vorticity confinement, 1/s: brings back curls that the grid loses
  float dissipation = 0.0f;  // fraction of the density lost per second
  float burning = 0.0f;      // density lost per second, whatever there is: flames end in sharp tongues
  float cooling = 0.0f;      // fraction of the heat lost per second
  float viscosity = 0.0f;    // heights^2/s
  float drag = 0.0f;         // fraction of the velocity lost per second
  float still_air = 0.0f;    // the same, where there is no fluid
  float top_speed = 0.0f;    // heights/s at which drag holds against buoyancy; 0: none
};

enum class Side { kOpen, kClosed };

struct Look {
  float opacity = 3.0f;         // alpha = 1 - exp(-opacity x density)
  Rgb thin{0.5f, 0.5f, 0.52f};  // the preview's colours, linear light
  Rgb dense{0.85f, 0.85f, 0.85f};
  float glow = 0.0f;  // 0: lit; 1: shines by itself
};

struct Design {
  int rows = 192;          // cells of the simulation along the picture's height; cells are square
  int steps = 2;           // of the simulation per frame
  double warm_up_s = 0.0;  // simulated before frame 0
  FluidOptions fluid;
  Side left = Side::kOpen, right = Side::kOpen, top = Side::kOpen, bottom = Side::kOpen;
  std::vector<Emitter> emitters;
  std::vector<Obstacle> obstacles;
  std::vector<Force> forces;
  Look look;
};

/// Cells of a design over a picture of this size.
cv::Size cells_of(const Design& design, cv::Size picture);

}  // namespace freshet::synth::simulate
