#include "synth/scene/kinds/clouds.h"

#include <cmath>

#include "synth/scene/kinds/kind_keys.h"

namespace freshet::synth::scene {
namespace {

void read_ground(Section& section, CloudMotion& clouds) { clouds.ground = line_of(section, "ground"); }

}  // namespace

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
       "speed at the layer's lowest row, a share of that at its highest"},
      {"shade",
       &CloudMotion::shade,
       {0, 1},
       "",
       "share of the light that shadows, gliding over the ground with the wind, take from all layers but "
       "clouds and added light"},
      {"shade_size",
       &CloudMotion::shade_size,
       {0.02, 10},
       "",
       "of the picture's width: size of a shadow in the foreground",
       {},
       Range{0.1, 1}},
      {"ground",
       read_ground,
       {},
       "",
       "[x, y, x, y] on the horizon of the ground that is shaded",
       "the first water's horizon, or the layer's lowest row"}};
  return keys;
}

void CloudMotion::check(const Section& section) const {
  if (ground && std::abs(ground->to.x - ground->from.x) < 1)
    section.refuse("ground", "it stands upright", "Draw it from left to right");
}

}  // namespace freshet::synth::scene
