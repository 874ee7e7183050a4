#include <oneapi/tbb/parallel_for.h>

#include <algorithm>

#include "freshet/error.h"
#include "store/codec/tile_codec.h"
#include "store/page_check.h"
#include "store/records/tile_record.h"
#include "store/store_impl.h"

namespace freshet::store {
namespace {

std::string range(std::uint64_t first, std::uint64_t end) {
  return std::to_string(first) + " to " + std::to_string(end - 1);
}

template <class Check>
void note(std::vector<std::string>& faults, const Check& check) {
  try {
    check();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::kIo) throw;  // what the disk does not give now is not damaged
    faults.emplace_back(error.what());
  }
}

}  // namespace

struct Snapshot::Impl::Verification {
  using Entry = ReadTransaction::Entry;
  using Faults = std::vector<std::string>;

  explicit Verification(const Impl& snapshot)
      : impl(snapshot), entries(impl.txn.entries(Table::kTiles)), counts(entries.size(), 0) {}

  void tiles();
  void coverage();
  void columns_and_blobs();

  // Their steps.
  std::uint32_t check_record(const Entry& entry, Faults& found) const;
  void check_tiles(const Entry& entry, const RecordPlace& place, const TileRecord& record,
                   Faults& found) const;
  void check_run(ClipId id, Stream stream, std::uint64_t tile_count, std::size_t& at);
  void check_array(Table table, const Bytes& prefix, const ArrayAccount& account);

  const Impl& impl;
  const std::vector<Entry> entries;   // of tiles, by key
  std::vector<std::uint32_t> counts;  // of tiles, by entry; 0 when it cannot be read
  Faults faults;
};

// Every tile of every record, on all threads.
void Snapshot::Impl::Verification::tiles() {
  std::vector<Faults> found(entries.size());
  tbb::parallel_for(std::size_t{0}, entries.size(),
                    [&](std::size_t i) { counts[i] = check_record(entries[i], found[i]); });
  for (const Faults& lines : found) faults.insert(faults.end(), lines.begin(), lines.end());
}

// The number of tiles that the record says it has; 0 when it cannot be read.
std::uint32_t Snapshot::Impl::Verification::check_record(const Entry& entry, Faults& found) const {
  std::uint32_t count = 0;
  note(found, [&] {
    const RecordPlace place = impl.txn.place(Table::kTiles, entry.key);
    if (entry.key.size() != kTileKeyBytes || static_cast<std::size_t>(entry.key[4]) >= kStreams) return;
    const TileRecord record(place, entry.value);
    count = record.count();
    const ClipId id{load_big_endian(entry.key.data())};
    if (!impl.records.contains(id)) return;  // check_account names it
    check_tiles(entry, place, record, found);
  });
  return count;
}

void Snapshot::Impl::Verification::check_tiles(const Entry& entry, const RecordPlace& place,
                                               const TileRecord& record, Faults& found) const {
  const TileGrid& grid =
      impl.grid(ClipId{load_big_endian(entry.key.data())}, static_cast<Stream>(entry.key[4]));
  const std::uint64_t first = load_big_endian(entry.key.data() + 5);
  if (first + record.count() > grid.tile_count())
    throw_damaged(place, "the record has more tiles than the clip");
  thread_local Bytes samples;
  for (std::uint32_t t = 0; t < record.count(); ++t)
    note(found, [&] {
      const TileBox box = grid.box(static_cast<std::uint32_t>(first + t));
      samples.resize(box.bytes());
      if (!decode_tile(box, record.tile(place, t), samples))
        throw_damaged(place, "tile " + std::to_string(first + t) + " does not decode");
    });
}

// No tile missing and none twice. A record that cannot be read has been named above and stands for the gap.
void Snapshot::Impl::Verification::coverage() {
  std::size_t at = 0;
  for (const auto& [id, clip] : impl.records)
    for (std::size_t s = 0; s < kStreams; ++s)
      check_run(id, static_cast<Stream>(s), clip.grids[s].tile_count(), at);
}

// at: an entry not behind the stream's first; it is left behind its last.
void Snapshot::Impl::Verification::check_run(ClipId id, Stream stream, std::uint64_t tile_count,
                                             std::size_t& at) {
  const Bytes first_key = tile_key(id, stream, 0);
  const ByteSpan prefix = ByteSpan(first_key).first(5);
  std::uint64_t expected = 0;
  bool unread = false;
  const auto meet = [&](std::uint64_t next) {
    if (next == expected || (unread && next > expected)) return;
    const RecordPlace place = impl.txn.place(Table::kTiles, first_key);
    note(faults, [&] {
      throw_damaged(place, next > expected ? "tiles " + range(expected, next) + " are missing"
                                           : "tiles " + range(next, expected) + " are there twice");
    });
  };
  const auto of_stream = [&](ByteSpan key) {
    return key.size() == kTileKeyBytes && std::equal(prefix.begin(), prefix.end(), key.begin());
  };
  while (at < entries.size() && std::ranges::lexicographical_compare(entries[at].key, prefix)) ++at;
  for (; at < entries.size() && of_stream(entries[at].key); ++at) {
    const std::uint64_t first = load_big_endian(entries[at].key.data() + 5);
    meet(first);
    expected = first + counts[at];
    unread = counts[at] == 0;
  }
  meet(tile_count);
}

// Whole.
void Snapshot::Impl::Verification::columns_and_blobs() {
  for (const auto& [id, clip] : impl.records)
    for (const auto& [name, account] : clip.columns)
      check_array(Table::kColumns, column_prefix(id, name), account);
  if (impl.account)
    for (const auto& [name, account] : impl.account->blobs)
      check_array(Table::kBlobs, blob_prefix(name), account);
}

void Snapshot::Impl::Verification::check_array(Table table, const Bytes& prefix,
                                               const ArrayAccount& account) {
  note(faults, [&] {
    const Chunks chunks = impl.chunks(table, prefix, account);
    Bytes bytes;
    for (const auto& [key, value] : chunks.entries) {
      const RecordPlace place = impl.txn.place(table, key);
      const Record record = open_record(place, value);
      bytes.resize(record.header.raw_bytes);
      decode_record(place, record, bytes);
    }
  });
}

std::vector<std::string> Snapshot::Impl::verify() const {
  Impl::Verification verification(*this);
  const Environment& environment = txn.environment();
  note(verification.faults,
       [&] { check_pages(environment.descriptor(), environment.file(), PageCheck::kAll); });
  verification.tiles();
  verification.coverage();
  verification.columns_and_blobs();
  // What has been named already, as one record that cannot be read, is not named again.
  for (std::string& fault : check_account())
    if (std::ranges::find(verification.faults, fault) == verification.faults.end())
      verification.faults.push_back(std::move(fault));
  return std::move(verification.faults);
}

std::vector<std::string> Snapshot::verify() const {
  std::vector<std::string> faults;
  for (const Impl* file : each_file())
    for (std::string& fault : file->verify()) faults.push_back(std::move(fault));
  return faults;
}

}  // namespace freshet::store
