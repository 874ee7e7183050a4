// synth/scene/kinds/patches.h — patches of a store (Okabe et al. 2011), as `freshet synth animate` makes them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "synth/scene/kinds/kind.h"

namespace freshet::synth::scene {

struct PatchesMotion {
  static constexpr const char* kName = "patches";
  static constexpr Pixels kPixels = Pixels::kCutAnimated;

  std::filesystem::path store{};
  std::string class_name{};            // empty: as it looks
  std::filesystem::path strokes{};     // empty: those of the scene's drawing that name this layer
  std::vector<std::string> options{};  // of freshet synth animate, word by word
};

template <>
const std::vector<Key<PatchesMotion>>& keys_of<PatchesMotion>();

}  // namespace freshet::synth::scene
