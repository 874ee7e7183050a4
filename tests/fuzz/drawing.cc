// Strokes and flow lines, SVG or JSON.

#include "hints/strokes.h"
#include "synth/flowlines/files/line_files.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const fuzz::InputFile file({bytes, size}, ".svg");
  std::vector<std::string> notices;
  fuzz::allow_errors([&] { hints::read_strokes(file.path(), {64, 48}, &notices); });
  fuzz::allow_errors([&] { synth::flowlines::read_lines(file.path(), {64, 48}, 4, &notices); });
  return 0;
}
