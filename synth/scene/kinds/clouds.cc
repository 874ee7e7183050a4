#include "synth/scene/kinds/clouds.h"

#include "synth/scene/kinds/kind_keys.h"

namespace freshet::synth::scene {

template <>
const std::vector<Key<CloudMotion>>& keys_of<CloudMotion>() {
  static const std::vector<Key<CloudMotion>> keys{
      {"speed",
       &CloudMotion::speed_px_per_s,
       {-1e4, 1e4},
       "px/s",
       "speed, negative to the left",
       "the wind's along the picture, .6 % of its width a second for each m/s",
       Range{-60, 60}},
      {"far_speed",
       &CloudMotion::far_speed,
       {0, 1},
       "",
       "speed at the layer's lowest row, a share of that at its highest"}};
  return keys;
}

}  // namespace freshet::synth::scene
