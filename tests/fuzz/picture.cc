// Pictures, as pictures, mattes, with alpha and at their own depth.

#include <array>

#include "media/picture/picture.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::array kEndings{".png", ".jpg", ".tif", ".exr", ".webp", ".bmp", ".pgm"};
  fuzz::Data data(bytes, size);
  const char* ending = kEndings[fuzz::take(data) % kEndings.size()];
  const fuzz::InputFile file(data, ending);
  fuzz::allow_errors([&] { media::read_picture(file.path()); });
  fuzz::allow_errors([&] { media::read_still(file.path()); });
  fuzz::allow_errors([&] { media::read_matte(file.path(), {40, 30}); });
  fuzz::allow_errors([&] { media::read_deep_picture(file.path()); });
  return 0;
}
