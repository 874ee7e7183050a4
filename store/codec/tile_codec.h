// store/codec/tile_codec.h — one tile, coded by itself and without loss.
#pragma once

#include "store/codec/tile_grid.h"

namespace freshet::store {

/// Appends the coded tile to `out`.
/// samples   box.bytes() bytes, frame-major, rows packed, little endian.
/// Cost      scratch is kept by the calling thread. Safe from many threads.
void encode_tile(const TileBox& box, ByteSpan samples, Bytes& out);

/// The reverse; `samples` is overwritten. False when `coded` is not a tile of this shape: nothing is trusted.
bool decode_tile(const TileBox& box, ByteSpan coded, std::span<std::byte> samples);

}  // namespace freshet::store
