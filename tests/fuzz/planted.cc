// A target with a planted fault: what finds nothing elsewhere is to find it here.

#include <string_view>

#include "tests/fuzz/fuzz.h"

using namespace freshet;

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  fuzz::expect(!text.starts_with("fault"), "no input begins with a fault");
  return 0;
}
