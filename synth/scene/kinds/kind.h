// synth/scene/kinds/kind.h — what every kind of motion says of itself. Each has a file beside this one.
#pragma once

#include <vector>

namespace freshet::synth {
template <class Object>
struct Key;
class Section;
}  // namespace freshet::synth

namespace freshet::synth::scene {

/// The rows of a kind (synth/toml/keys.h): what the reader, --keys, the manual and the studio's ranges walk.
template <class Kind>
const std::vector<Key<Kind>>& keys_of();

/// Where a layer's pixels come from.
enum class Pixels {
  kCut,          // cut from the picture, and moved
  kCutAnimated,  // cut from the picture, and made into frames of its own
  kOwn,          // frames that bring their own pixels and alpha; such a layer has no matte
};

}  // namespace freshet::synth::scene
