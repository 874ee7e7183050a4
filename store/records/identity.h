// store/records/identity.h — the 32 bytes that make an LMDB file a store, and bind its records to it.
#pragma once

#include <optional>

#include "store/format/format.h"

namespace freshet::store {

inline constexpr std::size_t kIdentityBytes = 32;

std::uint64_t draw_store_id();
Bytes encode_identity(std::uint64_t store_id);
/// The store id. Empty when the bytes are no identity of this version, or garbled.
std::optional<std::uint64_t> parse_identity(ByteSpan value);

}  // namespace freshet::store
