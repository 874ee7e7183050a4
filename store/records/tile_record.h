// store/records/tile_record.h — several tiles in one value, any of which can be read without the others.
//
// LMDB rounds a big value up to 4 KB pages: tiles stored singly would waste a tenth. A record is a run of
// consecutive tiles; its key is the number of the first. The payload is a directory, {u32 bytes, u64 hash} a
// tile, and then the tiles. The record's hash covers the directory, whose hashes cover the tiles: a reader
// touches only the pages of the tiles that it wants.
#pragma once

#include "store/records/record.h"

namespace freshet::store {

/// Gathers coded tiles into a record's value.
class TileRecordBuilder {
 public:
  void add(ByteSpan coded, std::size_t raw_bytes);
  std::uint32_t count() const { return static_cast<std::uint32_t>(sizes_.size()); }
  bool full() const { return tiles_.size() + sizes_.size() * kTileEntryBytes >= kTileRecordBytes; }
  /// The finished value; the builder is empty afterwards.
  Bytes take(const RecordPlace& place);

 private:
  std::vector<std::uint32_t> sizes_;
  Bytes tiles_;
  std::uint64_t raw_bytes_ = 0;
};

/// A tile record whose header and directory have been checked.
class TileRecord {
 public:
  TileRecord() = default;
  /// Throws Error{kDamaged}.
  TileRecord(const RecordPlace& place, ByteSpan value);
  std::uint32_t count() const { return record_.header.parameter; }
  std::uint64_t raw_bytes() const { return record_.header.raw_bytes; }
  /// The bytes of tile `index` < count(), their hash checked. Throws Error{kDamaged}.
  ByteSpan tile(const RecordPlace& place, std::uint32_t index) const;
  /// The same bytes unchecked, for fetching ahead.
  ByteSpan tile_unchecked(std::uint32_t index) const;

 private:
  Record record_;
  std::vector<std::uint64_t> ends_;  // of each tile, from the payload's start
};

}  // namespace freshet::store
