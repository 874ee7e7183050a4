// store/records/account.h — what records a store must hold, so that one that is lost, old or foreign is noticed.
//
// A record's hash binds its bytes to its key, but a record that is not there has no hash. So a clip says how
// many records its streams and columns have and what their hashes add up to, and the record `meta`, `account`
// says the same of the clips and of the blobs. The sums do not depend on the order; a sum is enough, for the
// hashes themselves are 64 bits that already depend on place and content.
#pragma once

#include <map>
#include <optional>

#include "store/format/format.h"

namespace freshet::store {

/// Records counted, and their hashes added modulo 2^64.
struct RecordSum {
  std::uint32_t records = 0;
  std::uint64_t hashes = 0;
  /// value   a record as it is kept, header first (at least kRecordHeaderBytes).
  void add(ByteSpan value);
  void subtract(ByteSpan value);
  bool operator==(const RecordSum&) const = default;
};

/// A column or a blob: all its chunks.
struct ArrayAccount {
  std::uint32_t element_bytes = 1;
  std::uint8_t flags = 0;
  std::uint64_t bytes = 0;  // decoded
  RecordSum sum;
  bool operator==(const ArrayAccount&) const = default;
};

/// How many records an array of so many bytes has. element_bytes is 1 to kChunkBytes.
std::uint64_t chunks_of(const ArrayAccount& array);

/// By name, in the order of keys: names have no zero bytes.
using ArrayAccounts = std::map<std::string, ArrayAccount, std::less<>>;

struct StoreAccount {
  std::uint32_t next_clip = 0;  // the number of the clip that is added next
  RecordSum clips;
  ArrayAccounts blobs;
};

inline constexpr std::string_view kIdentityKey = "store", kSettingsKey = "settings", kAccountKey = "account";
inline constexpr std::size_t kMaxAccountBytes = 64 << 20;

void append_sum(Bytes& to, const RecordSum& sum);
void append_arrays(Bytes& to, const ArrayAccounts& arrays);
class ByteCursor;
RecordSum take_sum(ByteCursor& cursor);
/// max_name   bytes. A name that no store may hold makes the cursor no longer good.
ArrayAccounts take_arrays(ByteCursor& cursor, std::size_t max_name);

Bytes serialise_account(const StoreAccount& account);
/// Empty when the bytes are no account of this version.
std::optional<StoreAccount> parse_account(ByteSpan bytes);

/// True when a column or blob may bear the name: 1 to `longest` bytes, none of them zero.
bool name_fits(std::string_view name, std::size_t longest);

}  // namespace freshet::store
