// The records that are there, compared with those that clips and store say there are.

#include <array>
#include <map>
#include <set>
#include <utility>

#include "freshet/error.h"
#include "store/records/record.h"
#include "store/store_impl.h"

namespace freshet::store {

struct Snapshot::Impl::AccountCheck {
  using Entry = ReadTransaction::Entry;

  const Impl& impl;
  std::vector<std::string> faults = {};

  void meta();
  void clips();
  void tiles();
  void columns();
  void blobs();

  // Their steps.
  template <class Check>
  bool note(const Check& check) {
    try {
      check();
      return true;
    } catch (const Error& error) {
      faults.emplace_back(error.what());
      return false;
    }
  }
  bool header_fits(const RecordPlace& place, ByteSpan value, bool of_tiles);
  enum class Owner { kKnown, kUnread, kNone };
  Owner owner(ByteSpan key) const;
  /// Records that are there.
  struct Found {
    RecordSum sum;
    std::uint64_t raw_bytes = 0;  // as their headers say
    void add(ByteSpan value) {
      sum.add(value);
      raw_bytes += load<std::uint64_t>(value.data() + 16);
    }
  };
  void compare(const RecordPlace& place, const RecordSum& written, std::uint64_t raw_bytes,
               const Found& found);
  struct Chunk {
    std::string name;
    std::uint32_t number;
  };
  std::optional<Chunk> chunk_of(const RecordPlace& place, ByteSpan rest, std::size_t max_name);
  void arrays(Table table, const Bytes& prefix, const ArrayAccounts& accounts,
              std::map<std::string, Found>& found);
};

bool Snapshot::Impl::AccountCheck::header_fits(const RecordPlace& place, ByteSpan value, bool of_tiles) {
  return note([&] {
    const Record record = open_header(place, value);
    if ((record.header.codec == Codec::kTiles) != of_tiles)
      throw_damaged(place, "the record is not of the kind that belongs there");
  });
}

// The clip that a key of tiles or columns begins with.
Snapshot::Impl::AccountCheck::Owner Snapshot::Impl::AccountCheck::owner(ByteSpan key) const {
  const ClipId id{load_big_endian(key.data())};
  if (impl.records.contains(id)) return Owner::kKnown;
  return impl.damaged.contains(id) ? Owner::kUnread : Owner::kNone;
}

void Snapshot::Impl::AccountCheck::compare(const RecordPlace& place, const RecordSum& written,
                                           std::uint64_t raw_bytes, const Found& found) {
  if (written == found.sum && raw_bytes == found.raw_bytes) return;
  note([&] {
    throw_damaged(place, written.records != found.sum.records
                             ? std::to_string(written.records) + " records were written and " +
                                   std::to_string(found.sum.records) + " are there"
                         : written != found.sum ? "the records are not those that were written last"
                                                : "the records' headers give another size than was written");
  });
}

void Snapshot::Impl::AccountCheck::meta() {
  for (const auto& [key, value] : impl.txn.entries(Table::kMeta)) {
    const std::string_view name(reinterpret_cast<const char*>(key.data()), key.size());
    const RecordPlace place = impl.txn.place(Table::kMeta, key);
    if (name == kIdentityKey) continue;
    if (name != kSettingsKey && name != kAccountKey)
      note([&] { throw_damaged(place, "a store has no such record"); });
    else
      header_fits(place, value, false);
  }
}

// Their bytes and their sum were looked at when the snapshot was taken.
void Snapshot::Impl::AccountCheck::clips() {
  for (const auto& [id, fault] : impl.damaged) faults.push_back(fault);
  if (!impl.account_fault.empty()) faults.push_back(impl.account_fault);
}

void Snapshot::Impl::AccountCheck::tiles() {
  std::map<std::pair<ClipId, std::size_t>, Found> found;
  for (const auto& [key, value] : impl.txn.entries(Table::kTiles)) {
    const RecordPlace place = impl.txn.place(Table::kTiles, key);
    if (key.size() != kTileKeyBytes || static_cast<std::size_t>(key[4]) >= kStreams) {
      note([&] { throw_damaged(place, "the key is garbled"); });
      continue;
    }
    const Owner whose = owner(key);
    if (whose == Owner::kNone) note([&] { throw_damaged(place, "the record belongs to no clip"); });
    if (whose != Owner::kKnown) continue;
    header_fits(place, value, true);
    found[{ClipId{load_big_endian(key.data())}, static_cast<std::size_t>(key[4])}].add(value);
  }
  for (const auto& [id, clip] : impl.records)
    for (std::size_t s = 0; s < kStreams; ++s) {
      const Bytes first = tile_key(id, static_cast<Stream>(s), 0);
      std::uint64_t frame_bytes = 0;
      const StreamShape& shape = clip.grids[s].shape();
      for (const PlaneShape& plane : shape.planes)
        frame_bytes += std::uint64_t{plane.width} * plane.height * plane.bytes_per_sample;
      compare(impl.txn.place(Table::kTiles, first), clip.tiles[s], frame_bytes * shape.frames,
              found[{id, s}]);
    }
}

// rest   of a key: the name, a zero byte, the chunk's number.
std::optional<Snapshot::Impl::AccountCheck::Chunk> Snapshot::Impl::AccountCheck::chunk_of(
    const RecordPlace& place, ByteSpan rest, std::size_t max_name) {
  Chunk chunk;
  const bool whole = note([&] {
    if (rest.size() < 6 || rest[rest.size() - 5] != std::byte{0}) throw_damaged(place, "the key is garbled");
    chunk.name.assign(reinterpret_cast<const char*>(rest.data()), rest.size() - 5);
    chunk.number = load_big_endian(rest.data() + rest.size() - 4);
    if (!name_fits(chunk.name, max_name)) throw_damaged(place, "the key is garbled");
  });
  return whole ? std::optional(chunk) : std::nullopt;
}

// All columns of a clip, or all blobs.
// prefix   of their keys, which the names follow.
void Snapshot::Impl::AccountCheck::arrays(Table table, const Bytes& prefix, const ArrayAccounts& accounts,
                                          std::map<std::string, Found>& found) {
  for (const auto& [name, account] : accounts) {
    Bytes key = prefix;
    const Bytes rest = blob_prefix(name);
    key.insert(key.end(), rest.begin(), rest.end());
    key.resize(key.size() + 4);  // its first chunk
    compare(impl.txn.place(table, key), account.sum, account.bytes, found[name]);
    found.erase(name);
  }
  for (const auto& [name, sum] : found) {
    Bytes key = prefix;
    const Bytes rest = blob_key(name, 0);
    key.insert(key.end(), rest.begin(), rest.end());
    note([&] { throw_damaged(impl.txn.place(table, key), "nothing of that name was written"); });
  }
}

void Snapshot::Impl::AccountCheck::columns() {
  std::map<ClipId, std::map<std::string, Found>> found;
  for (const auto& [key, value] : impl.txn.entries(Table::kColumns)) {
    const RecordPlace place = impl.txn.place(Table::kColumns, key);
    if (key.size() < 4) {
      note([&] { throw_damaged(place, "the key is garbled"); });
      continue;
    }
    const Owner whose = owner(key);
    if (whose == Owner::kNone) note([&] { throw_damaged(place, "the record belongs to no clip"); });
    if (whose != Owner::kKnown) continue;
    const auto chunk = chunk_of(place, key.subspan(4), kMaxColumnName);
    if (!chunk || !header_fits(place, value, false)) continue;
    found[ClipId{load_big_endian(key.data())}][chunk->name].add(value);
  }
  for (const auto& [id, clip] : impl.records) arrays(Table::kColumns, clip_key(id), clip.columns, found[id]);
}

void Snapshot::Impl::AccountCheck::blobs() {
  std::map<std::string, Found> found;
  for (const auto& [key, value] : impl.txn.entries(Table::kBlobs)) {
    const RecordPlace place = impl.txn.place(Table::kBlobs, key);
    const auto chunk = chunk_of(place, key, kMaxBlobName);
    if (!chunk || !header_fits(place, value, false)) continue;
    found[chunk->name].add(value);
  }
  if (impl.account) arrays(Table::kBlobs, {}, impl.account->blobs, found);
}

std::vector<std::string> Snapshot::Impl::check_account() const {
  Impl::AccountCheck check{*this};
  check.meta();
  check.clips();
  check.tiles();
  check.columns();
  check.blobs();
  return std::move(check.faults);
}

std::vector<std::string> Snapshot::check_account() const {
  std::vector<std::string> faults;
  for (const Impl* file : each_file())
    for (std::string& fault : file->check_account()) faults.push_back(std::move(fault));
  return faults;
}

}  // namespace freshet::store
