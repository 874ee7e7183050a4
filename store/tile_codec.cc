#include "store/tile_codec.h"

#include "store/zstd_context.h"

namespace freshet::store {

void encode_tile(const TileBox&, ByteSpan samples, Bytes& out) {
  const Bytes coded = zstd_compress(samples, 1);
  out.insert(out.end(), coded.begin(), coded.end());
}

bool decode_tile(const TileBox& box, ByteSpan coded, std::span<std::byte> samples) {
  return samples.size() == box.bytes() && zstd_expand(coded, samples);
}

}  // namespace freshet::store
