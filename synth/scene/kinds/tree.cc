#include "synth/scene/kinds/tree.h"

#include "synth/scene/kinds/kind_keys.h"

namespace freshet::synth::scene {
namespace {

void read_armatures(Section& section, TreeMotion& tree) { tree.armatures = lines_of(section, "armature"); }
void read_motion_armatures(Section& section, TreeMotion& tree) {
  tree.motion_armatures = lines_of(section, "motion_armature");
}

/// What is usual for each kind of plant; every key after it can still be given.
void take_plant(TreeMotion& tree, std::size_t plant) {
  if (plant == 0) return;
  // Stems of half a metre to a whole one swing at one to three hertz, a tenth of critically damped (de Langre 2008).
  tree.frequency_hz = 1.6;
  tree.damping_per_s = 2;
  tree.mass = plant == 1 ? 0.3 : 0.03;
  if (plant == 2) {
    tree.shimmer_px = 1;
    tree.stand = true;
  }
}

}  // namespace

void TreeMotion::check(const Section& section) const {
  for (const char* const key : {"motion_clip", "motion_armature"})
    if (motion_from.empty() && section.has(key))
      section.refuse(key, "it belongs to motion_from, and there is none",
                     "Give motion_from = \"FILM\", or take " + std::string(key) + " out");
  if (motion_from.empty()) return;
  for (const char* const key : {"frequency", "damping", "mass"})
    if (section.has(key))
      section.refuse(key, "it is measured in motion_from", "Leave out the one or the other");
  if (motion_armatures.empty())
    section.refuse("motion_from", "nothing says where in it the plant stands",
                   "Give motion_armature = [x, y, x, y] from root to tip in its first frame, px of it");
  for (const Line& line : motion_armatures)
    if (cv::norm(line.to - line.from) < 4)
      section.refuse("motion_armature", "it is shorter than 4 px",
                     "Draw it from the plant's root to its tip");
}

template <>
const std::vector<Key<TreeMotion>>& keys_of<TreeMotion>() {
  static const std::vector<Key<TreeMotion>> keys{
      {"armature",
       read_armatures,
       {},
       "",
       "[x, y, x, y], or a list of such lines, each from root to tip",
       "the marks'"},
      {"plant",
       Words<TreeMotion>{{"tree", "flower", "grass"}, take_plant},
       {},
       "",
       "usual values of what follows. Flower: frequency 1.6, damping 2, mass .3; grass: mass .03 and shimmer "
       "1, and its "
       "lines share one turbulence"},
      {"frequency", &TreeMotion::frequency_hz, {0.05, 10}, "Hz", "natural frequency"},
      {"damping", &TreeMotion::damping_per_s, {0.01, 100}, "1/s", "damping"},
      {"mass",
       &TreeMotion::mass,
       {0.01, 1e5},
       "kg",
       "mass for each N that 1 m/s of wind makes; displacements are in lengths of the armature"},
      {"foreshortening",
       &TreeMotion::foreshortening,
       {0, 1},
       "",
       "share of the length that is lost and won for a displacement of one length"},
      {"shimmer",
       &TreeMotion::shimmer_px,
       {0, 20},
       "px",
       "standard deviation of the leaves' own motion",
       {},
       Range{0, 4}},
      {"shimmer_size", &TreeMotion::shimmer_size_px, {4, 500}, "px", "size of what shimmers together"},
      {"motion_from",
       &TreeMotion::motion_from,
       {},
       "",
       "a video, numbered sequence, folder or store that shows such a plant sway: frequency, damping "
       "and mass are those under which the scene's wind, at its strongest, moves it as it is seen there",
       "none"},
      {"motion_clip", &TreeMotion::motion_clip, {}, "", "of a store: the clip's name", "none"},
      {"motion_armature",
       read_motion_armatures,
       {},
       "",
       "as armature, of the plant in the first frame of motion_from, px of it; needed there",
       "none"}};
  return keys;
}

}  // namespace freshet::synth::scene
