// OpenRaster: a zip of XML and pictures.

#include "media/picture/openraster.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const fuzz::InputFile file({bytes, size}, ".ora");
  fuzz::allow_errors([&] { media::read_openraster(file.path()); });
  return 0;
}
