// store/format/format.h — the constants and keys of the file format, shared by its writer and its reader.
//
// docs/format.md is the normative text. A change of meaning here is a new kFormatVersion.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "store/format/clip.h"

namespace freshet::store {

static_assert(std::endian::native == std::endian::little,
              "the store's numbers are used as they lie in the file");

inline constexpr std::uint32_t kFormatVersion = 3;
inline constexpr std::string_view kStoreMagic = "FRESHET\n";
inline constexpr std::uint32_t kRecordMagic = 0x31525246;  // "FRR1"

/// The named databases of the LMDB file.
enum class Table : std::uint8_t { kMeta = 0, kClips = 1, kTiles = 2, kColumns = 3, kBlobs = 4 };
inline constexpr std::size_t kTables = 5;
inline constexpr const char* kTableNames[kTables] = {"meta", "clips", "tiles", "columns", "blobs"};

/// How a record's payload is coded.
enum class Codec : std::uint8_t {
  kRaw = 0,      // as it is
  kZstd = 1,     // one zstd frame with checksum
  kShuffle = 2,  // bytes of equal significance brought together, then as kZstd
  kTiles = 3,    // a directory and tiles (tile_record.h)
};

inline constexpr std::uint32_t kSlabFrames = 16;  // frames of a tile
/// A tile record is closed when it has reached this.
inline constexpr std::size_t kTileRecordBytes = 128 << 10;
inline constexpr std::size_t kChunkBytes = 1 << 20;  // raw bytes of a record of a column or a blob
inline constexpr std::size_t kTileEntryBytes = 12;   // of a tile record's directory: size and hash
inline constexpr std::uint32_t kMaxPlanes = 8;
inline constexpr std::uint32_t kMaxPlaneEdge = 1 << 16;  // samples
inline constexpr std::uint32_t kMaxFrames = 1 << 24;
inline constexpr std::size_t kMaxColumnName = 200, kMaxBlobName = 400;  // bytes; an LMDB key holds 511

using Bytes = std::vector<std::byte>;
using ByteSpan = std::span<const std::byte>;

inline ByteSpan bytes_of(std::string_view text) { return std::as_bytes(std::span(text.data(), text.size())); }

/// Reads a value that may lie at any address.
template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

template <class T>
void append(Bytes& to, T value) {
  const std::size_t at = to.size();
  to.resize(at + sizeof(T));
  std::memcpy(to.data() + at, &value, sizeof(T));
}

inline std::uint32_t load_big_endian(const std::byte* from) {
  return __builtin_bswap32(load<std::uint32_t>(from));
}

// Keys. Numbers are big endian: the order of keys is the order of writing.
inline constexpr std::size_t kTileKeyBytes = 9;
Bytes clip_key(ClipId clip);
Bytes tile_key(ClipId clip, Stream stream, std::uint32_t first_tile);
/// What the keys of all chunks of a column or blob begin with: the name and a zero byte. The chunk's number
/// follows, so that the chunks lie together and in order.
Bytes column_prefix(ClipId clip, std::string_view name);
Bytes blob_prefix(std::string_view name);
Bytes column_key(ClipId clip, std::string_view name, std::uint32_t chunk);
Bytes blob_key(std::string_view name, std::uint32_t chunk);

/// What a key names, for a person: "clip 3, frames, tiles from 40".
std::string describe_key(Table table, ByteSpan key);

}  // namespace freshet::store
