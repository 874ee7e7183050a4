// store/records/column.h — the codec of columns, blobs and other plain bytes: shuffle, then zstd.
#pragma once

#include "store/format/format.h"

namespace freshet::store {

/// Appends the coded bytes to `out` and returns how they were coded: raw when nothing is smaller.
/// element_bytes   1 or 0 for plain bytes; shuffling is tried for 2, 4, 8 and any other size up to 256.
Codec compress_column(ByteSpan raw, std::uint32_t element_bytes, Bytes& out);

/// The reverse. False when the bytes do not decode to exactly out.size() bytes; nothing is trusted.
bool expand_column(Codec codec, ByteSpan stored, std::uint32_t element_bytes, std::span<std::byte> out);

}  // namespace freshet::store
