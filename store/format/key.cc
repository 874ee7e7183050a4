#include "store/format/format.h"

namespace freshet::store {
namespace {

void append_big_endian(Bytes& key, std::uint32_t value) { append(key, __builtin_bswap32(value)); }

void append_name(Bytes& key, std::string_view name) {
  const ByteSpan bytes = bytes_of(name);
  key.insert(key.end(), bytes.begin(), bytes.end());
  key.push_back(std::byte{0});
}

std::string name_of(ByteSpan text) { return {reinterpret_cast<const char*>(text.data()), text.size()}; }

std::string describe_chunk(ByteSpan rest) {
  if (rest.size() < 5) return "a record with a short key";
  std::string text = name_of(rest.first(rest.size() - 5));
  text.append(", chunk ").append(std::to_string(load_big_endian(rest.data() + rest.size() - 4)));
  return text;
}

}  // namespace

Bytes clip_key(ClipId clip) {
  Bytes key;
  append_big_endian(key, static_cast<std::uint32_t>(clip));
  return key;
}

Bytes tile_key(ClipId clip, Stream stream, std::uint32_t first_tile) {
  Bytes key = clip_key(clip);
  append(key, stream);
  append_big_endian(key, first_tile);
  return key;
}

Bytes column_prefix(ClipId clip, std::string_view name) {
  Bytes key = clip_key(clip);
  append_name(key, name);
  return key;
}

Bytes blob_prefix(std::string_view name) {
  Bytes key;
  append_name(key, name);
  return key;
}

Bytes column_key(ClipId clip, std::string_view name, std::uint32_t chunk) {
  Bytes key = column_prefix(clip, name);
  append_big_endian(key, chunk);
  return key;
}

Bytes blob_key(std::string_view name, std::uint32_t chunk) {
  Bytes key = blob_prefix(name);
  append_big_endian(key, chunk);
  return key;
}

std::string describe_key(Table table, ByteSpan key) {
  static constexpr const char* kStreamNames[] = {"frames", "flow", "average"};
  if (table == Table::kMeta) return "meta " + name_of(key);
  if (table == Table::kBlobs) return "blob " + describe_chunk(key);
  if (key.size() < 4) return "a record with a short key";
  const std::string clip = "clip " + std::to_string(load_big_endian(key.data()));
  if (table == Table::kColumns) return clip + ", column " + describe_chunk(key.subspan(4));
  if (table == Table::kTiles && key.size() == kTileKeyBytes) {
    const auto stream = static_cast<std::size_t>(key[4]);
    return clip + ", " + (stream < 3 ? kStreamNames[stream] : "unknown stream") + ", tiles from " +
           std::to_string(load_big_endian(key.data() + 5));
  }
  return clip;
}

}  // namespace freshet::store
