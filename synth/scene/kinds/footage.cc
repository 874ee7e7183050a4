#include "synth/scene/kinds/footage.h"

#include <cmath>
#include <optional>
#include <string>

#include "synth/scene/kinds/kind_keys.h"

namespace freshet::synth::scene {
namespace {

void read_at(Section& section, FootageMotion& footage) { footage.at = place_of(section, "at"); }
void take_ground(FootageMotion& footage, std::size_t word) {
  footage.ground = static_cast<media::Ground>(word);
}
/// A layer cut from the picture has more ways to say its matte.
void read_film_matte(Section& section, FootageMotion& footage) {
  constexpr const char* kRemedy =
      "Give matte = \"FILE\": a grey picture or film of the film's shape, white where the layer is";
  const std::optional<std::string> name = section.text("matte");
  if (!name) return;
  if (*name == "rest" || *name == "paint" || *name == "painted")
    section.refuse("matte", "it is of the picture, and this layer is a film", kRemedy);
  footage.matte = section.beside(*name);
}

}  // namespace

template <>
const std::vector<Key<FootageMotion>>& keys_of<FootageMotion>() {
  static const std::vector<Key<FootageMotion>> keys{
      {"file",
       &FootageMotion::file,
       {},
       "",
       "a numbered sequence (f.####.png) or video. Without alpha, matte and ground it covers its whole "
       "rectangle. Where it is shorter, and in a loop, its end goes over into its beginning",
       kNeeded},
      {"matte",
       read_film_matte,
       {},
       "",
       "white where the layer is, of the film's shape: a grey picture, which lies still over the film, or a "
       "numbered sequence, folder or video with a matte for each of its frames (grey, or alpha where any "
       "frame is transparent). It limits what its alpha or ground leaves",
       "none"},
      {"ground",
       Words<FootageMotion>{media::ground_names(), take_ground},
       {},
       "",
       "what the film was filmed on, which is taken off: light on black, as fire; dark on white, as smoke"},
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
