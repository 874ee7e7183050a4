// Tiles: any bytes decode or are refused; any samples come back as they were.

#include <algorithm>
#include <vector>

#include "store/codec/tile_codec.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

constexpr std::uint32_t kSamples = 4096;

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::Data data(bytes, size);
  store::TileBox box;
  box.width = 1u + fuzz::take(data) % 64;
  box.height = 1u + fuzz::take(data) % 64;
  // Of few samples, so that many are tried: wide, high or long, and not all at once.
  box.frames =
      1u + fuzz::take(data) % std::clamp(kSamples / (box.width * box.height), 1u, store::kSlabFrames);
  box.bytes_per_sample = fuzz::take(data) % 2 == 0 ? 1 : 2;
  std::vector<std::byte> samples(box.bytes());
  store::decode_tile(box, fuzz::bytes_of(data), samples);

  std::fill(samples.begin(), samples.end(), std::byte{});
  for (std::size_t i = 0; i < samples.size() && !data.empty(); ++i)
    samples[i] = std::byte{data[i % data.size()]};
  store::Bytes coded;
  store::encode_tile(box, samples, coded);
  std::vector<std::byte> again(samples.size());
  fuzz::expect(store::decode_tile(box, coded, again), "what was encoded decodes");
  fuzz::expect(again == samples, "samples come back as they were");
  return 0;
}
