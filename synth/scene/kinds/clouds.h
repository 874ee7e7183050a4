// synth/scene/kinds/clouds.h — translation (Chuang et al. 2005, Sec. 3.5).
#pragma once

#include <optional>

#include "synth/scene/kinds/kind.h"

namespace freshet::synth::scene {

struct CloudMotion {
  static constexpr const char* kName = "clouds";
  static constexpr Pixels kPixels = Pixels::kCut;

  /// Nothing: wind.speed * 0.6 % of the picture's width, along the wind.
  std::optional<double> speed_px_per_s{};
  double far_speed = 1;  // at the layer's lowest row, fractions of the speed at its highest
};

template <>
const std::vector<Key<CloudMotion>>& keys_of<CloudMotion>();

}  // namespace freshet::synth::scene
