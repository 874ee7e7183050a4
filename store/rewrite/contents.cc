#include "store/rewrite/contents.h"

#include <algorithm>
#include <utility>

#include "freshet/error.h"

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

}  // namespace freshet::store
