#include "store/records/account.h"

#include <algorithm>

#include "store/records/byte_cursor.h"
#include "store/records/record.h"

namespace freshet::store {

void RecordSum::add(ByteSpan value) {
  ++records;
  hashes += stated_hash(value);
}

void RecordSum::subtract(ByteSpan value) {
  --records;
  hashes -= stated_hash(value);
}

bool name_fits(std::string_view name, std::size_t longest) {
  return !name.empty() && name.size() <= longest && name.find('\0') == std::string_view::npos;
}

void append_sum(Bytes& to, const RecordSum& sum) {
  append(to, sum.records);
  append(to, sum.hashes);
}

RecordSum take_sum(ByteCursor& cursor) {
  RecordSum sum;
  sum.records = cursor.take<std::uint32_t>();
  sum.hashes = cursor.take<std::uint64_t>();
  return sum;
}

void append_arrays(Bytes& to, const ArrayAccounts& arrays) {
  append(to, static_cast<std::uint32_t>(arrays.size()));
  for (const auto& [name, array] : arrays) {
    append_string(to, name);
    append(to, array.element_bytes);
    append(to, array.flags);
    append(to, array.bytes);
    append_sum(to, array.sum);
  }
}

ArrayAccounts take_arrays(ByteCursor& cursor, std::size_t max_name) {
  ArrayAccounts arrays;
  const auto count = cursor.take<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && cursor.good(); ++i) {
    std::string name = cursor.take_string();
    ArrayAccount array;
    array.element_bytes = cursor.take<std::uint32_t>();
    array.flags = cursor.take<std::uint8_t>();
    array.bytes = cursor.take<std::uint64_t>();
    array.sum = take_sum(cursor);
    if (!cursor.good()) break;
    const bool new_name = name_fits(name, max_name) && (arrays.empty() || arrays.rbegin()->first < name);
    if (!new_name || array.element_bytes == 0 || array.element_bytes > kChunkBytes ||
        array.sum.records != chunks_of(array)) {
      cursor.spoil();
      break;
    }
    arrays.emplace(std::move(name), array);
  }
  return arrays;
}

std::uint64_t chunks_of(const ArrayAccount& array) {
  const std::uint64_t step = kChunkBytes / array.element_bytes * array.element_bytes;
  return std::max<std::uint64_t>(array.bytes / step + (array.bytes % step != 0 ? 1 : 0), 1);
}

Bytes serialise_account(const StoreAccount& account) {
  Bytes bytes;
  append(bytes, account.next_clip);
  append_sum(bytes, account.clips);
  append_arrays(bytes, account.blobs);
  return bytes;
}

std::optional<StoreAccount> parse_account(ByteSpan bytes) {
  ByteCursor cursor(bytes);
  StoreAccount account;
  account.next_clip = cursor.take<std::uint32_t>();
  account.clips = take_sum(cursor);
  account.blobs = take_arrays(cursor, kMaxBlobName);
  if (!cursor.finished()) return std::nullopt;
  return account;
}

}  // namespace freshet::store
