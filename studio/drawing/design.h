// studio/drawing/design.h — a motion of sources, obstacles and winds that were drawn.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studio/drawing/drawn.h"

namespace freshet::studio {

class Fields;

/// A motion that is simulated, and may be given the look of a clip.
struct Design {
  std::string fluid = "smoke";     // "smoke", "fire", "water"
  std::vector<Drawn> sources;      // what does not add is an obstacle
  std::vector<DrawnStroke> winds;  // of which the first and the last point count
  std::string look;                // a clip of the store; empty: as simulated
  std::string ground = "black";    // of that clip: as `synth transfer --ground`
  int frames = 72;                 // 1..500
  bool full = false;               // the picture's size, not a draft's
  bool operator==(const Design&) const = default;
};

/// Checks everything, as document_from_json says.
Design read_design(const Fields& fields);
nlohmann::json design_json(const Design& design);

}  // namespace freshet::studio
