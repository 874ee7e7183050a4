#include "synth/scene/kinds/footage.h"

#include "synth/scene/kinds/kind_keys.h"

namespace freshet::synth::scene {
namespace {

void read_at(Section& section, FootageMotion& footage) { footage.at = place_of(section, "at"); }

}  // namespace

template <>
const std::vector<Key<FootageMotion>>& keys_of<FootageMotion>() {
  static const std::vector<Key<FootageMotion>> keys{
      {"file",
       &FootageMotion::file,
       {},
       "",
       "a numbered sequence (f.####.png) or video with alpha. Where it is shorter, and in a loop, its end "
       "goes over into "
       "its beginning",
       kNeeded},
      {"at", read_at, {}, "", "[x, y], px: its upper left corner", "0, 0"},
      {"width",
       &FootageMotion::width,
       {1, 65536},
       "px",
       "width that it is shown with, in its own shape",
       "its own"}};
  return keys;
}

}  // namespace freshet::synth::scene
