// All that is TOML: scenes to simulate, scenes of layers, edits of stills.

#include "synth/scene/scene_file.h"
#include "synth/simulate/design/scene_file.h"
#include "synth/stills/edits.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::Data data(bytes, size);
  const int kind = fuzz::take(data) % 3;
  if (kind == 0) {
    fuzz::allow_errors([&] { synth::scene::parse_scene(fuzz::text_of(data), "fuzzed.toml"); });
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
