#include "store/rewrite/contents.h"

#include <algorithm>
#include <utility>

#include "freshet/error.h"
#include "store/records/tile_record.h"

namespace freshet::store {
namespace {

constexpr std::size_t kMaxSettingsBytes = 64 << 20;

// As std::less of two entries' keys, where a prefix stands for all keys that begin with it.
struct ByPrefix {
  std::size_t size;
  ByteSpan head(ByteSpan key) const { return key.first(std::min(size, key.size())); }
  bool operator()(const Contents::Entry& entry, ByteSpan prefix) const {
    return std::ranges::lexicographical_compare(head(entry.key), prefix);
  }
  bool operator()(ByteSpan prefix, const Contents::Entry& entry) const {
    return std::ranges::lexicographical_compare(prefix, head(entry.key));
  }
};

Bytes meta_record(const ReadTransaction& txn, std::string_view name, std::size_t max_bytes) {
  const RecordPlace at = txn.place(Table::kMeta, bytes_of(name));
  const auto value = txn.get(Table::kMeta, at.key);
  if (!value) throw_damaged(at, "the record is missing");
  return decode_record(at, *value, max_bytes);
}

}  // namespace

std::span<const Contents::Entry> Contents::entries(Table which, ByteSpan prefix) const {
  const std::vector<Entry>& all = table(which);
  const auto [first, last] = std::equal_range(all.begin(), all.end(), prefix, ByPrefix{prefix.size()});
  return {first, last};
}

Contents read_contents(const std::shared_ptr<Environment>& environment) {
  const auto txn = std::make_shared<ReadTransaction>(environment);
  Contents contents{.file = environment->file(), .store_id = environment->store_id()};
  const Bytes text = meta_record(*txn, kSettingsKey, kMaxSettingsBytes);
  contents.settings.assign(reinterpret_cast<const char*>(text.data()), text.size());
  const auto account = parse_account(meta_record(*txn, kAccountKey, kMaxAccountBytes));
  const RecordPlace account_at = txn->place(Table::kMeta, bytes_of(kAccountKey));
  if (!account) throw_damaged(account_at, "the store's account of its records is garbled");
  contents.next_clip = account->next_clip;
  contents.blobs = account->blobs;
  for (std::size_t t = 0; t < kTables; ++t) contents.tables[t] = txn->entries(static_cast<Table>(t));
  RecordSum found;
  for (const auto& [key, value] : contents.table(Table::kClips)) {
    const RecordPlace at = txn->place(Table::kClips, key);
    auto clip = key.size() != 4 ? std::nullopt : parse_clip(decode_record(at, value, kMaxClipRecordBytes));
    if (!clip) throw_damaged(at, "the clip's record is garbled");
    contents.clips.emplace(ClipId{load_big_endian(key.data())}, std::move(*clip));
    found.add(value);
  }
  if (found != account->clips) throw_damaged(account_at, "the clips are not those that were written");
  contents.held = txn;
  return contents;
}

void check_array(const Contents& contents, Table table, ByteSpan prefix, const ArrayAccount& account) {
  RecordSum sum;
  std::uint64_t bytes = 0;
  for (const auto& [key, value] : contents.entries(table, prefix)) {
    const RecordPlace at = contents.place(table, key);
    const Record record = open_record(at, value);
    if (key.size() != prefix.size() + 4 || load_big_endian(key.data() + prefix.size()) != sum.records)
      throw_damaged(at, "the chunk before it is missing");
    bytes += record.header.raw_bytes;
    sum.add(value);
  }
  if (sum == account.sum && bytes == account.bytes) return;
  throw_damaged(contents.place(table, prefix), "the records are not those that were written last");
}

void check_stream(const Contents& contents, ClipId id, Stream stream, const RecordSum& written) {
  const Bytes first = tile_key(id, stream, 0);
  RecordSum sum;
  for (const auto& [key, value] : contents.entries(Table::kTiles, ByteSpan(first).first(5))) {
    const RecordPlace at = contents.place(Table::kTiles, key);
    const TileRecord record(at, value);
    for (std::uint32_t t = 0; t < record.count(); ++t) record.tile(at, t);
    sum.add(value);
  }
  if (sum == written) return;
  throw_damaged(contents.place(Table::kTiles, first), std::to_string(written.records) +
                                                          " records were written and " +
                                                          std::to_string(sum.records) + " of them are there");
}

}  // namespace freshet::store
