// All that is TOML: scenes to simulate, scenes of layers, tours, edits of stills.

#include "synth/scene/scene_file.h"
#include "synth/simulate/design/scene_file.h"
#include "synth/stills/edits.h"
#include "synth/tour/tour_file.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::Data data(bytes, size);
  const int kind = fuzz::take(data) % 4;
  if (kind == 0) {
    fuzz::allow_errors([&] { synth::scene::parse_scene(fuzz::text_of(data), "fuzzed.toml"); });
    return 0;
  }
  if (kind == 3) {
    fuzz::allow_errors([&] {
      const synth::tour::TourPlan plan = synth::tour::parse_tour(fuzz::text_of(data), "fuzzed.toml");
      const synth::tour::Room room(synth::tour::mesh_of(plan, {64, 48}), "fuzzed.toml");
      if (!plan.keys.empty()) synth::tour::Path(plan.keys, plan.ease).at(0.5);
    });
    return 0;
  }
  const fuzz::InputFile file(data, ".toml");
  fuzz::allow_errors([&] {
    if (kind == 1)
      synth::simulate::read_scene(file.path());
    else
      synth::stills::read_edits(file.path());
  });
  return 0;
}
