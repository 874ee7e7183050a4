#include "synth/scene/kinds/patches.h"

#include "synth/scene/kinds/kind_keys.h"

namespace freshet::synth::scene {

template <>
const std::vector<Key<PatchesMotion>>& keys_of<PatchesMotion>() {
  static const std::vector<Key<PatchesMotion>> keys{
      {"store", &PatchesMotion::store, {}, "", "the store file", kNeeded},
      {"class",
       &PatchesMotion::class_name,
       {},
       "",
       "class of the clips that are used; any: of all",
       "as it looks"},
      {"strokes",
       &PatchesMotion::strokes,
       {},
       "",
       "SVG or JSON of strokes along the flow",
       "those of the marks that name the layer"},
      {"options",
       &PatchesMotion::options,
       {},
       "",
       "further options of freshet synth animate, word by word: [\"--direction\", \"down\"]",
       "none"}};
  return keys;
}

}  // namespace freshet::synth::scene
