#include "store/records/tile_record.h"

#include <xxhash.h>

namespace freshet::store {

void TileRecordBuilder::add(ByteSpan coded, std::size_t raw_bytes) {
  sizes_.push_back(static_cast<std::uint32_t>(coded.size()));
  tiles_.insert(tiles_.end(), coded.begin(), coded.end());
  raw_bytes_ += raw_bytes;
}

Bytes TileRecordBuilder::take(const RecordPlace& place) {
  const std::size_t directory = sizes_.size() * kTileEntryBytes;
  Bytes value(kRecordHeaderBytes);
  value.reserve(kRecordHeaderBytes + directory + tiles_.size());
  const std::byte* tile = tiles_.data();
  for (const std::uint32_t size : sizes_) {
    append(value, size);
    append(value, XXH3_64bits_withSeed(tile, size, place.store_id));
    tile += size;
  }
  value.insert(value.end(), tiles_.begin(), tiles_.end());
  RecordHeader header;
  header.codec = Codec::kTiles;
  header.parameter = count();
  header.raw_bytes = raw_bytes_;
  seal_record(place, header, directory, value);
  sizes_.clear();
  tiles_.clear();
  raw_bytes_ = 0;
  return value;
}

TileRecord::TileRecord(const RecordPlace& place, ByteSpan value) : record_(open_record(place, value)) {
  if (record_.header.codec != Codec::kTiles) throw_damaged(place, "the record holds no tiles");
  std::uint64_t end = std::uint64_t{count()} * kTileEntryBytes;
  ends_.reserve(count());
  for (std::uint32_t i = 0; i < count(); ++i) {
    end += load<std::uint32_t>(record_.payload.data() + std::size_t{i} * kTileEntryBytes);
    ends_.push_back(end);
  }
  if (end != record_.payload.size()) throw_damaged(place, "the tiles' lengths do not add up to the record's");
}

ByteSpan TileRecord::tile_unchecked(std::uint32_t index) const {
  const std::uint64_t start = index == 0 ? std::uint64_t{count()} * kTileEntryBytes : ends_[index - 1];
  return record_.payload.subspan(start, ends_[index] - start);
}

ByteSpan TileRecord::tile(const RecordPlace& place, std::uint32_t index) const {
  const ByteSpan bytes = tile_unchecked(index);
  const auto hash = load<std::uint64_t>(record_.payload.data() + std::size_t{index} * kTileEntryBytes + 4);
  if (XXH3_64bits_withSeed(bytes.data(), bytes.size(), place.store_id) != hash) {
    throw_damaged(place,
                  "the hash of tile " + std::to_string(index) + " of the record does not fit its bytes");
  }
  return bytes;
}

}  // namespace freshet::store
