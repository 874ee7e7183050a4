#include "synth/scene/kinds/footage.h"

#include <cmath>

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
       "its own"},
      {"start",
       &FootageMotion::start_s,
       {0, 1e5},
       "s",
       "when it begins; nothing of it is seen before, but in a loop its end",
       {},
       Range{0, 10}},
      {"repeat", &FootageMotion::repeats, {}, "", "false: it plays once, and is gone"}};
  return keys;
}

int start_frame(const FootageMotion& footage, double fps) {
  return static_cast<int>(std::lround(footage.start_s * fps));
}

}  // namespace freshet::synth::scene
