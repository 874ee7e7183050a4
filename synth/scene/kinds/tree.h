// synth/scene/kinds/tree.h — branches and plants (Chuang et al. 2005, Sec. 3.2).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "synth/scene/kinds/kind.h"
#include "synth/scene/kinds/line.h"

namespace freshet::synth::scene {

struct TreeMotion {
  static constexpr const char* kName = "tree";
  static constexpr Pixels kPixels = Pixels::kCut;

  std::vector<Line> armatures{};  // each from the root to the tip; not empty once marks are read
  double frequency_hz = 0.5;      // natural
  double damping_per_s = 0.6;     // gamma = c / m
  double mass = 6;  // kg for each N that 1 m/s of wind makes; displacements in lengths of the armature
  double foreshortening = 0;    // Sec. 4: of the length, lost and won for a displacement of one length
  double shimmer_px = 0;        // Sec. 5: standard deviation of the leaves' own motion at the mean wind
  double shimmer_size_px = 12;  // of what shimmers together
  bool stand = false;  // its armatures have one turbulence, as what stands close together; else each its own
  /// Film, or store and its clip, of a plant: frequency, damping and mass are then measured in it (measure_plants).
  std::filesystem::path motion_from{};
  std::string motion_clip{};
  std::vector<Line> motion_armatures{};  // px of the film's first frame

  void check(const Section& section) const;
};

template <>
const std::vector<Key<TreeMotion>>& keys_of<TreeMotion>();

}  // namespace freshet::synth::scene
