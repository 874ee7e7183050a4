// synth/scene/kinds/clouds.h — translation (Chuang et al. 2005, Sec. 3.5).
#pragma once

#include <optional>

#include "synth/scene/kinds/kind.h"
#include "synth/scene/kinds/line.h"

namespace freshet::synth {
class Section;
}

namespace freshet::synth::scene {

struct CloudMotion {
  static constexpr const char* kName = "clouds";
  static constexpr Pixels kPixels = Pixels::kCut;

  /// Nothing: wind.speed * 0.6 % of the picture's width, along the wind.
  std::optional<double> speed_px_per_s{};
  double far_speed = 1;          // at the layer's lowest row, fractions of the speed at its highest
  double shade = 0;              // of the light that shadows on the ground take, fractions
  double shade_size = 0.4;       // of a shadow in the foreground, of the picture's width
  std::optional<Line> ground{};  // on its horizon; nothing: the first water's, or the layer's lowest row

  /// What its keys ask of each other.
  void check(const Section& section) const;
};

template <>
const std::vector<Key<CloudMotion>>& keys_of<CloudMotion>();

}  // namespace freshet::synth::scene
