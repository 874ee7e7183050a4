#include "synth/scene/kinds/still.h"

#include "synth/scene/kinds/kind_keys.h"

namespace freshet::synth::scene {

template <>
const std::vector<Key<StillMotion>>& keys_of<StillMotion>() {
  static const std::vector<Key<StillMotion>> keys;
  return keys;
}

}  // namespace freshet::synth::scene
