#include "synth/scene/kinds/transfer.h"

#include "synth/scene/kinds/kind_keys.h"

namespace freshet::synth::scene {
namespace {

void take_ground(TransferMotion& transfer, std::size_t word) {
  transfer.ground = static_cast<media::Ground>(word);
}
void read_at(Section& section, TransferMotion& transfer) { transfer.at = place_of(section, "at"); }

}  // namespace

template <>
const std::vector<Key<TransferMotion>>& keys_of<TransferMotion>() {
  static const std::vector<Key<TransferMotion>> keys{
      {"design_alpha",
       &TransferMotion::design_alpha,
       {},
       "",
       "the design's masks: a folder, pattern or video. In a loop its last frames go over into those before "
       "its first: it "
       "has 4 to 24 frames more than the scene",
       kNeeded},
      {"design_flow", &TransferMotion::design_flow, {}, "", "the design's flow, as many frames", kNeeded},
      {"exemplar",
       &TransferMotion::exemplar,
       {},
       "",
       "the look: a picture, folder, pattern or video",
       kNeeded},
      {"exemplar_alpha", &TransferMotion::exemplar_alpha, {}, "", "masks of the exemplar", "its own alpha"},
      {"ground",
       Words<TransferMotion>{media::ground_names(), take_ground},
       {},
       "",
       "what the exemplar lies on: light on black, as fire; dark on white, as smoke"},
      {"at", read_at, {}, "", "[x, y], px: its upper left corner", "0, 0"}};
  return keys;
}

}  // namespace freshet::synth::scene
