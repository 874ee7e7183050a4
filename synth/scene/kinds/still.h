// synth/scene/kinds/still.h — what stays where it is.
#pragma once

#include "synth/scene/kinds/kind.h"

namespace freshet::synth::scene {

struct StillMotion {
  static constexpr const char* kName = "still";
  static constexpr Pixels kPixels = Pixels::kCut;
};

template <>
const std::vector<Key<StillMotion>>& keys_of<StillMotion>();

}  // namespace freshet::synth::scene
