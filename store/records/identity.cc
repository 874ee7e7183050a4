#include "store/records/identity.h"

#include <xxhash.h>

#include <algorithm>
#include <random>

namespace freshet::store {

std::uint64_t draw_store_id() {
  std::random_device random;
  return std::uint64_t{random()} << 32 | random();
}

Bytes encode_identity(std::uint64_t store_id) {
  Bytes identity(kIdentityBytes);
  const auto put = [&](std::size_t at, const auto& value) {
    std::memcpy(&identity[at], &value, sizeof value);
  };
  std::memcpy(identity.data(), kStoreMagic.data(), kStoreMagic.size());
  put(8, kFormatVersion);
  put(16, store_id);
  put(24, XXH3_64bits(identity.data(), 24));
  return identity;
}

std::optional<std::uint64_t> parse_identity(ByteSpan value) {
  if (value.size() != kIdentityBytes) return std::nullopt;
  const auto id = load<std::uint64_t>(value.data() + 16);
  if (!std::ranges::equal(value, encode_identity(id))) return std::nullopt;
  return id;
}

}  // namespace freshet::store
