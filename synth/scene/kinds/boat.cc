#include "synth/scene/kinds/boat.h"

#include "synth/scene/kinds/kind_keys.h"

namespace freshet::synth::scene {
namespace {

void read_hull(Section& section, BoatMotion& boat) { boat.hull = line_of(section, "hull"); }

}  // namespace

template <>
const std::vector<Key<BoatMotion>>& keys_of<BoatMotion>() {
  static const std::vector<Key<BoatMotion>> keys{
      {"hull", read_hull, {}, "", "[x, y, x, y] along the waterline", "the marks'"},
      {"water", &BoatMotion::water, {}, "", "the layer that it floats on", "the first of water"},
      {"heave", &BoatMotion::heave, {0, 100}, "", "how much of the water's rise and fall it makes"},
      {"roll", &BoatMotion::roll, {0, 100}, "", "how much of the water's tilt it makes", {}, Range{0, 10}},
      {"in_3d",
       &BoatMotion::in_3d,
       {},
       "",
       "true: a sheet that stands on the water, and heaves, pitches, rolls and yaws there as the waves under "
       "a hull of its length do; false: it is turned in the picture's plane, as in the paper"},
      {"reflection_of",
       &BoatMotion::reflection_of,
       {},
       "",
       "the boat that this layer mirrors: it rolls the other way",
       "none"}};
  return keys;
}

}  // namespace freshet::synth::scene
