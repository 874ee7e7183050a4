// store/records/record.h — the header that every value of the store carries, and its check.
//
// LMDB 0.9 checks nothing that it reads. The hash of a record binds its bytes to its key and to its store: a
// record that is whole but in the wrong place is found out too.
#pragma once

#include <filesystem>

#include "store/format/format.h"

namespace freshet::store {

/// Where a record lies, for its hash and for messages. Borrowed.
struct RecordPlace {
  const std::filesystem::path& file;
  std::uint64_t store_id;
  Table table;
  ByteSpan key;
};

inline constexpr std::size_t kRecordHeaderBytes = 48;
inline constexpr std::uint8_t kOutsideDigest = 1;  // flag: the blob takes no part in the digest

struct RecordHeader {
  Codec codec = Codec::kRaw;
  std::uint8_t flags = 0;
  std::uint32_t parameter = 0;     // bytes an element (columns), number of tiles (tile records), else 0
  std::uint64_t raw_bytes = 0;     // of the payload when decoded
  std::uint64_t total_bytes = 0;   // of the whole column or blob that this record is a chunk of
  std::uint64_t stored_bytes = 0;  // of the payload as it lies after the header
};

struct Record {
  RecordHeader header;
  ByteSpan payload;  // borrowed from the map
};

/// Throws Error{kDamaged} naming file and record.
[[noreturn]] void throw_damaged(const RecordPlace& place, const std::string& fault);

/// Writes the header in front of a payload. value holds kRecordHeaderBytes of room and then the payload,
/// whose first hashed_bytes the hash covers: all of it, or a tile record's directory.
void seal_record(const RecordPlace& place, RecordHeader header, std::size_t hashed_bytes,
                 std::span<std::byte> value);

/// The hash that a record says it has; 0 where it is shorter than a header.
std::uint64_t stated_hash(ByteSpan value);

/// Checks what can be checked without reading the payload: header and length. Throws Error{kDamaged}.
Record open_header(const RecordPlace& place, ByteSpan value);

/// Checks header, length, place and hash. Throws Error{kDamaged}.
Record open_record(const RecordPlace& place, ByteSpan value);

/// A whole value: the raw bytes coded by the smallest of the codecs that apply (shuffling pays where element
/// bytes differ in significance), with its header.
Bytes encode_record(const RecordPlace& place, ByteSpan raw, std::uint32_t element_bytes,
                    std::uint64_t total_bytes, std::uint8_t flags = 0);

/// The raw bytes of a record of any codec except kTiles. out.size() must be header.raw_bytes.
void decode_record(const RecordPlace& place, const Record& record, std::span<std::byte> out);
/// The same into fresh memory, refused above max_bytes.
Bytes decode_record(const RecordPlace& place, ByteSpan value, std::size_t max_bytes);

}  // namespace freshet::store
