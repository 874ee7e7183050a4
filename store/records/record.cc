#include "store/records/record.h"

#include <xxhash.h>

#include <memory>

#include "freshet/error.h"
#include "store/records/column.h"

namespace freshet::store {
namespace {

constexpr std::size_t kHashOffset = 40;

struct FreeState {
  void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};

std::uint64_t record_hash(const RecordPlace& place, ByteSpan header, ByteSpan hashed) {
  thread_local const std::unique_ptr<XXH3_state_t, FreeState> state(XXH3_createState());
  const std::uint8_t where[2] = {static_cast<std::uint8_t>(place.table), 0};
  const auto key_bytes = static_cast<std::uint16_t>(place.key.size());
  XXH3_64bits_reset_withSeed(state.get(), place.store_id);
  XXH3_64bits_update(state.get(), header.data(), kHashOffset);
  XXH3_64bits_update(state.get(), where, sizeof where);
  XXH3_64bits_update(state.get(), &key_bytes, sizeof key_bytes);
  XXH3_64bits_update(state.get(), place.key.data(), place.key.size());
  XXH3_64bits_update(state.get(), hashed.data(), hashed.size());
  return XXH3_64bits_digest(state.get());
}

}  // namespace

void throw_damaged(const RecordPlace& place, const std::string& fault) {
  throw Error(ErrorKind::kDamaged, place.file.string() + ", " + describe_key(place.table, place.key), fault,
              "Restore the file from a copy, or ingest its clips again into a new store");
}

void seal_record(const RecordPlace& place, RecordHeader header, std::size_t hashed_bytes,
                 std::span<std::byte> value) {
  header.stored_bytes = value.size() - kRecordHeaderBytes;
  std::byte* at = value.data();
  std::memset(at, 0, kRecordHeaderBytes);
  std::memcpy(at, &kRecordMagic, 4);
  at[4] = static_cast<std::byte>(header.codec);
  at[5] = static_cast<std::byte>(header.flags);
  std::memcpy(at + 8, &header.parameter, 4);
  std::memcpy(at + 16, &header.raw_bytes, 8);
  std::memcpy(at + 24, &header.total_bytes, 8);
  std::memcpy(at + 32, &header.stored_bytes, 8);
  const std::uint64_t hash =
      record_hash(place, value.first(kHashOffset), value.subspan(kRecordHeaderBytes, hashed_bytes));
  std::memcpy(at + kHashOffset, &hash, 8);
}

std::uint64_t stated_hash(ByteSpan value) {
  return value.size() < kRecordHeaderBytes ? 0 : load<std::uint64_t>(value.data() + kHashOffset);
}

Record open_header(const RecordPlace& place, ByteSpan value) {
  if (value.size() < kRecordHeaderBytes) throw_damaged(place, "the record is shorter than its header");
  const std::byte* at = value.data();
  if (load<std::uint32_t>(at) != kRecordMagic)
    throw_damaged(place, "the record does not begin with its mark");
  Record record;
  record.header.codec = static_cast<Codec>(at[4]);
  record.header.flags = static_cast<std::uint8_t>(at[5]);
  record.header.parameter = load<std::uint32_t>(at + 8);
  record.header.raw_bytes = load<std::uint64_t>(at + 16);
  record.header.total_bytes = load<std::uint64_t>(at + 24);
  record.header.stored_bytes = load<std::uint64_t>(at + 32);
  record.payload = value.subspan(kRecordHeaderBytes);
  if (record.header.stored_bytes != record.payload.size()) {
    throw_damaged(place, "the record says " + std::to_string(record.header.stored_bytes) + " bytes and has " +
                             std::to_string(record.payload.size()));
  }
  if (static_cast<std::uint8_t>(at[4]) > static_cast<std::uint8_t>(Codec::kTiles)) {
    throw_damaged(place, "the record's codec " + std::to_string(static_cast<int>(at[4])) + " is unknown");
  }
  return record;
}

Record open_record(const RecordPlace& place, ByteSpan value) {
  Record record = open_header(place, value);
  std::size_t hashed = record.payload.size();
  if (record.header.codec == Codec::kTiles) {
    const std::uint64_t directory = std::uint64_t{record.header.parameter} * kTileEntryBytes;
    if (directory > record.payload.size()) throw_damaged(place, "the record is shorter than its directory");
    hashed = static_cast<std::size_t>(directory);
  }
  if (record_hash(place, value.first(kHashOffset), record.payload.first(hashed)) != stated_hash(value)) {
    throw_damaged(place, "the record's hash does not fit its bytes and its place");
  }
  return record;
}

Bytes encode_record(const RecordPlace& place, ByteSpan raw, std::uint32_t element_bytes,
                    std::uint64_t total_bytes, std::uint8_t flags) {
  Bytes value(kRecordHeaderBytes);
  RecordHeader header;
  header.codec = compress_column(raw, element_bytes, value);
  header.flags = flags;
  header.parameter = element_bytes;
  header.raw_bytes = raw.size();
  header.total_bytes = total_bytes;
  seal_record(place, header, value.size() - kRecordHeaderBytes, value);
  return value;
}

void decode_record(const RecordPlace& place, const Record& record, std::span<std::byte> out) {
  if (out.size() != record.header.raw_bytes)
    throw_damaged(place, "the record's raw size is not the expected one");
  if (!expand_column(record.header.codec, record.payload, record.header.parameter, out)) {
    throw_damaged(place, "the record's payload does not decode");
  }
}

Bytes decode_record(const RecordPlace& place, ByteSpan value, std::size_t max_bytes) {
  const Record record = open_record(place, value);
  if (record.header.raw_bytes > max_bytes) {
    throw_damaged(place,
                  "the record says that it holds " + std::to_string(record.header.raw_bytes) + " bytes");
  }
  Bytes raw(record.header.raw_bytes);
  decode_record(place, record, raw);
  return raw;
}

}  // namespace freshet::store
