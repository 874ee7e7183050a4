// studio/drawing/drawn_scene.h — a picture in layers that one wind moves, as they are painted over it.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>

#include "studio/drawing/drawn.h"

namespace freshet::studio {

class Fields;

/// Where a layer is: exactly what was painted, what is found from scribbles on it and beside it, or what all others
/// leave.
enum class LayerMatte { kPainted, kScribbled, kRest };

/// How a layer moves: a row for each `motion` of a scene file that a person can draw.
struct DrawnMotion {
  const char* name;
  enum class Lines { kNone, kFirst, kAll } marks = Lines::kNone;  // which of its lines are marks of the scene
  const char* missing = nullptr;  // what to say where it has no line; null: needs none
  const char* remedy = nullptr;
};
inline constexpr DrawnMotion kDrawnMotions[] = {
    {"still"},
    {"tree", DrawnMotion::Lines::kAll, "it has no armature", "Draw one from its root to its tip"},
    {"water", DrawnMotion::Lines::kFirst, "it has no horizon", "Draw a line on the horizon"},
    {"boat", DrawnMotion::Lines::kFirst, "it has no hull line", "Draw one along its waterline"},
    {"clouds"},
    {"patches", DrawnMotion::Lines::kAll},
    {"footage"}};
/// Throws Error{kNotFound}.
const DrawnMotion& drawn_motion(const std::string& name);

/// One layer. Of what its motion does not have, the values do not matter.
struct DrawnLayer {
  std::string name;              // 1 to 60 letters, digits, '-', '_' and spaces; unique
  std::string motion = "still";  // of kDrawnMotions
  LayerMatte matte = LayerMatte::kPainted;
  std::vector<Drawn> paint{};
  /// From the first point to the last: armatures of a tree, from the root; water's horizon and a boat's hull line, of
  /// which the first line counts; strokes of patches. Of footage, from its upper left corner to its lower right one.
  std::vector<DrawnStroke> lines{};
  std::string plant = "tree";  // "tree", "flower", "grass"
  std::string sway_clip{};     // of a tree: a clip in which such a plant sways (motion_from); empty: none
  bool sway_dropped = true;    // it was dropped (own_clip_path); else it is the store's
  std::vector<DrawnStroke> sway_lines{};  // from root to tip in its first frame, px of it
  double shimmer = 0;        // of leaves, px; this and the other numbers in the scene file's ranges
  double waves = 0;          // amplitude; 0: the usual
  bool mirrors = false;      // of water: what moves above it
  double roll = 1;           // of a boat, and how much it heaves
  bool in_3d = false;        // of a boat
  double drift = 0;          // of clouds, px/s; 0: as the wind blows
  double shade = 0;          // of clouds, on the ground
  std::string class_name{};  // of patches; empty: all
  std::string film =
      "design";        // footage of: "design", "flowlines", "stills" (what these modes have made), "clip"
  std::string clip{};  // of film "clip": one that was dropped (own_clip_path)
  std::string matte_clip{};     // of footage, in place of paint: a dropped clip of its mattes; empty: none
  double start = 0;             // of footage, s
  bool repeats = true;          // of footage
  std::string ground = "none";  // of footage: "none", "black", "white", which is taken off
  std::string blend = "over";   // "over", "add", "screen"
  double glow = 0;              // of patches, footage and water, on the layers around
  double glow_reach = 0;        // px; 0: the usual
  bool operator==(const DrawnLayer&) const = default;
};

struct DrawnScene {
  double wind = 5;       // m/s
  double direction = 0;  // degrees, where it blows to, seen from above: 0 right, 90 away from the viewer
  double gustiness = 0;
  bool changes =
      false;  // weather: the wind becomes the next, by the film's end, or by a loop's middle and back
  double becomes = 12;  // m/s
  int frames = 100;     // 1..2000
  bool loop = true;
  std::vector<DrawnLayer> layers{};  // nearest first
  bool operator==(const DrawnScene&) const = default;
};

/// Checks everything, as document_from_json says.
DrawnScene read_scene(const Fields& fields);
nlohmann::json scene_json(const DrawnScene& scene);

}  // namespace freshet::studio
