// Columns: any bytes expand or are refused; any column comes back as it was.

#include <vector>

#include "store/records/column.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::Data data(bytes, size);
  const std::uint32_t element = 1u + fuzz::take(data) % 128;
  const auto codec = static_cast<store::Codec>(fuzz::take(data) % 3);
  const std::size_t elements = fuzz::take<std::uint16_t>(data) % 4096;
  std::vector<std::byte> out(element * elements);
  store::expand_column(codec, fuzz::bytes_of(data), element, out);

  const auto raw = fuzz::bytes_of(data.first(data.size() / element * element));
  store::Bytes stored;
  const store::Codec chosen = store::compress_column(raw, element, stored);
  std::vector<std::byte> again(raw.size());
  fuzz::expect(store::expand_column(chosen, stored, element, again), "what was compressed expands");
  fuzz::expect(std::equal(again.begin(), again.end(), raw.begin()), "a column comes back as it was");
  return 0;
}
