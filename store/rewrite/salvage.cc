#include "store/rewrite/salvage.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "freshet/error.h"
#include "store/records/tile_record.h"
#include "store/rewrite/record_scan.h"

namespace freshet::store {
namespace {

constexpr std::size_t kMaxSettingsBytes = 64 << 20;
constexpr std::size_t kMaxIdentities = 8;  // a page of another store's may have come in; more is no accident

/// What one store has in the file.
class Settlement {
 public:
  Settlement(const RecordScan& scan, const RecordScan::Identity& identity, const std::filesystem::path& file,
             const Rebuildable& index, const Job& job)
      : scan_(scan), index_(index), job_(job), hash_budget_(4 * scan.file_bytes + (64 << 20)) {
    found_.contents.file = file;
    found_.contents.store_id = identity.store_id;
    found_.contents.held = scan.held;
    for (const RecordScan::Entry& entry : scan.entries) take(entry);
    settle_clips();
  }
  std::size_t clips() const { return taken_.size(); }
  const ClipRecord* named(const ClipRecord& other) const {
    const auto same = std::ranges::find_if(
        taken_, [&](const auto& each) { return same_clip(each.second.clip.record, other); });
    return same == taken_.end() ? nullptr : &same->second.clip.record;
  }
  /// Those that could be taken.
  template <class Visit>
  void each_clip(const Visit& visit) const {
    for (const auto& [id, clip] : taken_) visit(id, clip.clip.record);
  }
  Salvage finish(std::vector<RepairReport::Lost> of_other_stores);

 private:
  struct Version {
    ByteSpan key, value;
    bool live;
  };
  using Versions = std::vector<Version>;  // of one key, each once; live ones first
  struct ByKey {
    bool operator()(ByteSpan a, ByteSpan b) const { return std::ranges::lexicographical_compare(a, b); }
  };
  using Entries = std::vector<Contents::Entry>;
  struct Clip {
    ClipId id;
    StoredClip clip;
    ByteSpan value;
    bool live;
    Entries tiles = {};
    std::map<std::string, Entries> columns = {};  // those of the index that are not whole are missing
  };
  struct Account {
    StoreAccount account;
    bool live;
  };

  static bool same_clip(const ClipRecord& a, const ClipRecord& b) {
    return a.name == b.name && a.source_hash == b.source_hash;
  }
  RecordPlace place(Table table, ByteSpan key) const { return found_.contents.place(table, key); }
  static bool may_stand(Table table, ByteSpan key);
  void take(const RecordScan::Entry& entry);
  void settle_clips();
  void settle(Clip clip);
  void gather(Clip& clip) const;
  std::optional<Entries> chain(Table table, ByteSpan prefix, std::uint64_t end, const RecordSum& written,
                               const ArrayAccount* array) const;
  Entries expect_chain(Table table, const Bytes& prefix, std::uint64_t end, const RecordSum& written,
                       const ArrayAccount* array) const;
  std::vector<Account> accounts() const;
  void settle_settings();
  void settle_blobs(const StoreAccount* account);
  bool index_fits(const StoreAccount* account) const;
  void name_lost(const Account* last);
  void write_contents(bool with_index);
  std::set<ClipId> nameless() const;

  const RecordScan& scan_;
  const Rebuildable& index_;
  const Job& job_;
  std::uint64_t hash_budget_;
  std::array<std::map<ByteSpan, Versions, ByKey>, kTables> versions_;
  std::map<ClipId, Clip> taken_;
  RecordSum taken_sum_;
  std::vector<RepairReport::Lost> lost_, displaced_;  // not whole; whole, and in another clip's way
  std::map<std::string, Entries> blobs_;
  Salvage found_;
};

/// The tables in which a key may stand.
bool Settlement::may_stand(Table table, ByteSpan key) {
  switch (table) {
    case Table::kMeta:
      return std::ranges::equal(key, bytes_of(kSettingsKey)) ||
             std::ranges::equal(key, bytes_of(kAccountKey));
    case Table::kClips:
      return key.size() == 4;
    case Table::kTiles:
      return key.size() == kTileKeyBytes && static_cast<std::size_t>(key[4]) < kStreams;
    case Table::kColumns:
      return key.size() >= 10 && key[key.size() - 5] == std::byte{0};
    case Table::kBlobs:
      return key.size() >= 6 && key[key.size() - 5] == std::byte{0};
  }
  return false;
}

void Settlement::take(const RecordScan::Entry& entry) {
  const ByteSpan key = entry.key, value = entry.value;
  for (std::size_t t = 0; t < kTables; ++t) {
    const auto table = static_cast<Table>(t);
    if (!may_stand(table, key)) continue;
    const auto known = versions_[t].find(key);
    if (known != versions_[t].end() && std::ranges::any_of(known->second, [&](const Version& other) {
          return stated_hash(other.value) == stated_hash(value) && other.value.size() == value.size();
        }))
      return;  // pages that were copied keep their old entries
    // Entries that all name one huge value would be hashed without end.
    if (value.size() > hash_budget_) {
      if (found_.report.doubts.empty())
        found_.report.doubts.emplace_back(
            "more entries name the same bytes than a store's would; not all were tried");
      return;
    }
    hash_budget_ -= value.size();
    if (job_.stop.stop_requested())
      throw Error(ErrorKind::kCancelled, found_.contents.file.string(), "stopped");
    try {
      const RecordPlace at = place(table, key);
      if (table == Table::kTiles) {
        const TileRecord tiles(at, value);
        for (std::uint32_t i = 0; i < tiles.count(); ++i) tiles.tile(at, i);
      } else {
        open_record(at, value);
      }
      versions_[t][key].push_back({key, value, entry.live});
      return;
    } catch (const Error&) {
      // Not of this table, or damaged.
    }
  }
}

/// Records with keys `prefix` and 0, and then the number that the record before leads to, up to `end`, whose hashes add
/// up to what was written. Of a key that has several versions the first that does.
///
/// array   of chunks, what their headers are to say; null of tiles.
std::optional<Settlement::Entries> Settlement::chain(Table table, ByteSpan prefix, std::uint64_t end,
                                                     const RecordSum& written,
                                                     const ArrayAccount* array) const {
  struct Step {
    const Versions* versions;
    std::size_t next = 0;
    std::uint64_t first = 0;  // number in the key
  };
  const auto& all = versions_[static_cast<std::size_t>(table)];
  // How far a version leads; 0 where it cannot be of this array.
  const auto span = [&](const Version& version) -> std::uint64_t {
    const RecordHeader header = open_header(place(table, version.key), version.value).header;
    if (array == nullptr) return header.parameter;
    return header.total_bytes == array->bytes && header.parameter == array->element_bytes &&
           header.flags == array->flags && header.raw_bytes <= kChunkBytes;
  };
  std::vector<Step> steps;
  RecordSum sum;
  Bytes key(prefix.begin(), prefix.end());
  key.resize(prefix.size() + sizeof(std::uint32_t));
  std::uint64_t at = 0;
  // Enough for records that have one version each; what was damaged has few of several.
  for (std::size_t left = 4 * std::min<std::size_t>(written.records, all.size()) + (1 << 16); left > 0;
       --left) {
    if (at == end && sum == written) {
      Entries entries;
      std::uint64_t raw = 0;
      for (const Step& step : steps) {
        const Version& version = (*step.versions)[step.next - 1];
        entries.push_back({version.key, version.value});
        raw += open_header(place(table, version.key), version.value).header.raw_bytes;
      }
      if (array == nullptr || raw == array->bytes) return entries;
    }
    if (at < end && sum.records < written.records) {
      const auto number = __builtin_bswap32(static_cast<std::uint32_t>(at));
      std::memcpy(&key[prefix.size()], &number, sizeof number);
      if (const auto found = all.find(key); found != all.end()) steps.push_back({&found->second, 0, at});
    }
    for (bool moved = false; !moved && !steps.empty();) {
      Step& step = steps.back();
      if (step.next > 0) sum.subtract((*step.versions)[step.next - 1].value);
      at = step.first;
      while (step.next < step.versions->size() && !moved) {
        const Version& version = (*step.versions)[step.next++];
        if (const std::uint64_t leads = span(version); leads > 0 && leads <= end - at) {
          sum.add(version.value);
          at += leads;
          moved = true;
        }
      }
      if (!moved) steps.pop_back();
    }
    if (steps.empty()) return std::nullopt;
  }
  return std::nullopt;
}

/// Throws Error{kDamaged} where they are not all there.
Settlement::Entries Settlement::expect_chain(Table table, const Bytes& prefix, std::uint64_t end,
                                             const RecordSum& written, const ArrayAccount* array) const {
  if (auto entries = chain(table, prefix, end, written, array)) return std::move(*entries);
  std::size_t found = 0;
  const auto& all = versions_[static_cast<std::size_t>(table)];
  for (auto v = all.lower_bound(prefix); v != all.end(); ++v, ++found)
    if (v->first.size() < prefix.size() || !std::ranges::equal(v->first.first(prefix.size()), prefix)) break;
  Bytes first = prefix;
  first.resize(first.size() + sizeof(std::uint32_t));
  throw_damaged(place(table, first), found < written.records
                                         ? std::to_string(written.records) + " records were written and " +
                                               std::to_string(found) + " of them are there"
                                         : "the records are not those that were written last");
}

/// Finds all records of a clip. Throws Error{kDamaged} where one is missing that is not of the index.
void Settlement::gather(Clip& clip) const {
  for (std::size_t s = 0; s < kStreams; ++s) {
    Bytes prefix = tile_key(clip.id, static_cast<Stream>(s), 0);
    prefix.resize(prefix.size() - sizeof(std::uint32_t));
    const Entries tiles =
        expect_chain(Table::kTiles, prefix, clip.clip.grids[s].tile_count(), clip.clip.tiles[s], nullptr);
    clip.tiles.insert(clip.tiles.end(), tiles.begin(), tiles.end());
  }
  for (const auto& [name, column] : clip.clip.columns) {
    const Bytes prefix = column_prefix(clip.id, name);
    if (!index_.columns.contains(name))
      clip.columns[name] = expect_chain(Table::kColumns, prefix, column.sum.records, column.sum, &column);
    else if (auto words = chain(Table::kColumns, prefix, column.sum.records, column.sum, &column))
      clip.columns[name] = std::move(*words);
  }
}

void Settlement::settle_clips() {
  std::vector<Clip> clips;
  for (const auto& [key, versions] : versions_[static_cast<std::size_t>(Table::kClips)])
    for (const Version& version : versions) {
      try {
        auto clip = parse_clip(decode_record(place(Table::kClips, key), version.value, kMaxClipRecordBytes));
        if (clip)
          clips.push_back(
              {ClipId{load_big_endian(key.data())}, std::move(*clip), version.value, version.live});
      } catch (const Error&) {
        // It does not decode.
      }
    }
  // Of two that cannot both be had, that which the trees lead to; else that with an index.
  std::ranges::stable_sort(clips, {}, [](const Clip& clip) {
    return std::tuple(!clip.live, clip.id, -static_cast<std::int64_t>(clip.clip.columns.size()));
  });
  for (Clip& clip : clips) settle(std::move(clip));
  std::erase_if(lost_, [&](const RepairReport::Lost& lost) {
    ClipRecord record;
    record.name = lost.name;
    record.source_hash = lost.source_hash;
    return named(record) != nullptr;
  });
}

void Settlement::settle(Clip clip) {
  const ClipRecord& record = clip.clip.record;
  if (named(record) != nullptr) return;  // an older record of it, or another copy
  const auto same = [&](const RepairReport::Lost& lost) {
    return lost.id == clip.id && lost.name == record.name && lost.source_hash == record.source_hash;
  };
  const auto say = [&](std::vector<RepairReport::Lost>& to, const std::string& fault) {
    if (std::ranges::none_of(to, same)) to.push_back({clip.id, record.name, record.source_hash, fault});
  };
  try {
    gather(clip);
  } catch (const Error& error) {
    return say(lost_, error.what());
  }
  std::string other;
  if (const auto number = taken_.find(clip.id); number != taken_.end())
    other = number->second.clip.record.name;
  for (const auto& [id, taken] : taken_)
    if (taken.clip.record.name == record.name || taken.clip.record.source_hash == record.source_hash)
      other = taken.clip.record.name;
  if (!other.empty() || taken_.contains(clip.id))
    return say(displaced_, "its number, name or source is that of \"" + other + "\", which was kept");
  taken_sum_.add(clip.value);
  const ClipId id = clip.id;
  taken_.emplace(id, std::move(clip));
}

std::vector<Settlement::Account> Settlement::accounts() const {
  std::vector<Account> read;
  const ByteSpan key = bytes_of(kAccountKey);
  const auto& all = versions_[static_cast<std::size_t>(Table::kMeta)];
  const auto found = all.find(key);
  if (found == all.end()) return read;
  for (const Version& version : found->second) {
    try {
      auto account = parse_account(decode_record(place(Table::kMeta, key), version.value, kMaxAccountBytes));
      if (account) read.push_back({std::move(*account), version.live});
    } catch (const Error&) {
      // It does not decode.
    }
  }
  return read;
}

void Settlement::settle_settings() {
  const ByteSpan key = bytes_of(kSettingsKey);
  const auto& all = versions_[static_cast<std::size_t>(Table::kMeta)];
  if (const auto found = all.find(key); found != all.end())
    for (const Version& version : found->second) {
      try {
        const Bytes text = decode_record(place(Table::kMeta, key), version.value, kMaxSettingsBytes);
        found_.contents.settings.assign(reinterpret_cast<const char*>(text.data()), text.size());
        return;
      } catch (const Error&) {
        // It does not decode.
      }
    }
  throw_damaged(place(Table::kMeta, key), "the settings are lost, and with them what its clips mean");
}

/// Clips of which there are records, but not the one that says what they are.
std::set<ClipId> Settlement::nameless() const {
  std::set<ClipId> ids;
  for (const Table table : {Table::kTiles, Table::kColumns})
    for (const auto& [key, versions] : versions_[static_cast<std::size_t>(table)])
      ids.insert(ClipId{load_big_endian(key.data())});
  std::erase_if(ids, [&](ClipId id) {
    return taken_.contains(id) ||
           std::ranges::find(found_.report.lost, id, &RepairReport::Lost::id) != found_.report.lost.end();
  });
  return ids;
}

void Settlement::settle_blobs(const StoreAccount* account) {
  RepairReport& report = found_.report;
  std::set<std::string> names;
  if (account != nullptr) {
    for (const auto& [name, blob] : account->blobs) {
      const Bytes prefix = blob_prefix(name);
      if (auto entries = chain(Table::kBlobs, prefix, blob.sum.records, blob.sum, &blob)) {
        blobs_[name] = std::move(*entries);
        found_.contents.blobs[name] = blob;
      } else {
        names.insert(name);
      }
    }
  } else {
    for (const auto& [key, versions] : versions_[static_cast<std::size_t>(Table::kBlobs)])
      names.emplace(reinterpret_cast<const char*>(key.data()), key.size() - 5);
  }
  for (const std::string& name : names)
    if (!index_.blobs.contains(name)) report.lost_blobs.push_back(name);
}

/// Whether all of the index was written for just the clips that were taken.
bool Settlement::index_fits(const StoreAccount* account) const {
  return account != nullptr && account->clips == taken_sum_ &&
         std::ranges::all_of(account->blobs,
                             [&](const auto& blob) {
                               return !index_.blobs.contains(blob.first) || blobs_.contains(blob.first);
                             }) &&
         std::ranges::all_of(taken_, [&](const auto& each) {
           return each.second.columns.size() == each.second.clip.columns.size();
         });
}

/// last   what says most of the clips that there were; null when nothing does.
void Settlement::name_lost(const Account* last) {
  RepairReport& report = found_.report;
  const bool exact = last != nullptr && last->live && scan_.trees_are_last;
  if (!exact || last->account.clips != taken_sum_) {
    report.lost = std::exchange(lost_, {});
    const std::uint32_t next = last == nullptr ? 0 : last->account.next_clip;
    std::set<ClipId> known;
    for (const auto& [id, clip] : taken_) known.insert(id);
    for (const RepairReport::Lost& lost : report.lost) known.insert(lost.id);
    const auto of_last = static_cast<std::uint32_t>(
        std::ranges::count_if(known, [&](ClipId id) { return static_cast<std::uint32_t>(id) < next; }));
    const std::uint32_t written = last == nullptr ? 0 : last->account.clips.records;
    report.unknown = written > of_last ? written - of_last : 0;
    for (const ClipId id : nameless()) {
      const bool counted = static_cast<std::uint32_t>(id) < next;
      if (counted ? report.unknown == 0 : exact) continue;
      report.lost.push_back({id, "", "", "its record, and with it its name and source, is lost"});
      if (counted) --report.unknown;
    }
    if (!exact)
      report.doubts.emplace_back(
          "the last account of its clips is lost: a clip of which nothing is left is not in this list");
  }
  // Else of a transaction that never ended, unless the trees themselves are of an earlier state.
  for (RepairReport::Lost& lost : lost_)
    if (!taken_.contains(lost.id)) report.lost.push_back(std::move(lost));
  report.lost.insert(report.lost.end(), displaced_.begin(), displaced_.end());
}

void Settlement::write_contents(bool with_index) {
  Contents& contents = found_.contents;
  const auto put = [&](Table table, const Entries& entries) {
    auto& to = contents.tables[static_cast<std::size_t>(table)];
    to.insert(to.end(), entries.begin(), entries.end());
  };
  const auto leave_out = [&](const auto& names) {
    return [&names, with_index](const auto& each) { return !with_index && names.contains(each.first); };
  };
  for (auto& [id, clip] : taken_) {
    put(Table::kTiles, clip.tiles);
    std::erase_if(clip.clip.columns, leave_out(index_.columns));
    for (const auto& [name, column] : clip.clip.columns) put(Table::kColumns, clip.columns[name]);
    contents.next_clip = std::max(contents.next_clip, static_cast<std::uint32_t>(id) + 1);
    contents.clips.emplace(id, std::move(clip.clip));
  }
  std::erase_if(contents.blobs, leave_out(index_.blobs));
  for (const auto& [name, blob] : contents.blobs) put(Table::kBlobs, blobs_[name]);
}

Salvage Settlement::finish(std::vector<RepairReport::Lost> of_other_stores) {
  RepairReport& report = found_.report;
  settle_settings();
  const std::vector<Account> all = accounts();
  // That which has the sum of just these clips binds the index to them; the last one says how many there were.
  const auto fits =
      std::ranges::find_if(all, [&](const Account& each) { return each.account.clips == taken_sum_; });
  const auto live = std::ranges::find_if(all, [](const Account& each) { return each.live; });
  const auto largest =
      std::ranges::max_element(all, {}, [](const Account& each) { return each.account.next_clip; });
  const auto last = scan_.trees_are_last && live != all.end() ? live : largest;
  name_lost(last == all.end() ? nullptr : &*last);
  const auto chosen = fits != all.end() ? fits : last;
  settle_blobs(chosen == all.end() ? nullptr : &chosen->account);
  if (last != all.end()) found_.contents.next_clip = last->account.next_clip;

  const bool has_index =
      std::ranges::any_of(taken_,
                          [&](const auto& each) {
                            return std::ranges::any_of(each.second.clip.columns, [&](const auto& column) {
                              return index_.columns.contains(column.first);
                            });
                          }) ||
      std::ranges::any_of(versions_[static_cast<std::size_t>(Table::kBlobs)], [&](const auto& blob) {
        const std::string name(reinterpret_cast<const char*>(blob.first.data()), blob.first.size() - 5);
        return index_.blobs.contains(name);
      });
  const bool with_index = fits != all.end() && index_fits(&fits->account);
  report.index_left_out = has_index && !with_index;
  write_contents(with_index);
  report.clips = taken_.size();
  report.lost.insert(report.lost.end(), of_other_stores.begin(), of_other_stores.end());
  return std::move(found_);
}

}  // namespace

Salvage salvage(const std::filesystem::path& file, const Rebuildable& index, const Job& job) {
  const RecordScan scan = scan_records(file, job);
  if (scan.identities.empty())
    throw Error(
        ErrorKind::kInput, file.string(),
        "is no Freshet store of this version, or its identity is lost, without which no record can be "
        "told from another store's",
        "Restore the file from a copy, or ingest its clips again into a new store");
  std::vector<Settlement> stores;
  for (const RecordScan::Identity& identity : scan.identities)
    if (stores.size() < kMaxIdentities) stores.emplace_back(scan, identity, file, index, job);
  const auto kept = std::ranges::max_element(stores, {}, &Settlement::clips);
  std::vector<RepairReport::Lost> foreign;
  for (auto store = stores.begin(); store != stores.end(); ++store)
    if (store != kept)
      store->each_clip([&](ClipId id, const ClipRecord& clip) {
        if (kept->named(clip) == nullptr)
          foreign.push_back(
              {id, clip.name, clip.source_hash, "it is of another store, whose pages are in the file"});
      });
  Salvage found = kept->finish(std::move(foreign));
  if (scan.identities.size() > kMaxIdentities)
    found.report.doubts.push_back("pages of " + std::to_string(scan.identities.size()) + " stores are in it");
  return found;
}

}  // namespace freshet::store
