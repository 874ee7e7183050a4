// synth/scene/kinds/boat.h — what floats, or is mirrored by the water below it (Chuang et al. 2005, Sec. 3.4).
#pragma once

#include <optional>
#include <string>

#include "synth/scene/kinds/kind.h"
#include "synth/scene/kinds/line.h"

namespace freshet::synth::scene {

struct BoatMotion {
  static constexpr const char* kName = "boat";
  static constexpr Pixels kPixels = Pixels::kCut;

  std::optional<Line> hull{};  // set once marks are read
  std::string water{};         // name of the layer that it floats on; empty: the first of water
  double heave = 1, roll = 1;  // gains
  bool in_3d = false;          // it heaves, pitches, rolls and yaws in the world; else in the picture's plane
  std::string reflection_of{};  // name of the boat whose reflection this is; empty: it is a boat itself
};

template <>
const std::vector<Key<BoatMotion>>& keys_of<BoatMotion>();

}  // namespace freshet::synth::scene
