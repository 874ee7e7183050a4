#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "freshet/error.h"
#include "store/codec/tile_codec.h"
#include "store/records/tile_record.h"
#include "store/store_impl.h"

namespace freshet::store {
namespace {

// What LMDB spends on a value: a place in a page of keys, and whole pages for a value that does not fit
// there.
std::uint64_t bytes_on_disk(const ReadTransaction::Entry& entry) {
  constexpr std::uint64_t kPage = 4096, kPageHeader = 16, kNode = 10, kMaxInside = 2038;
  const std::uint64_t node = kNode + entry.key.size() + entry.value.size();
  if (node <= kMaxInside) return node;
  return kNode + entry.key.size() + 8 + (kPageHeader + entry.value.size() + kPage - 1) / kPage * kPage;
}

// The raw size that a record states; 0 where it cannot be read.
std::uint64_t stated_raw_bytes(ByteSpan value) {
  return value.size() < kRecordHeaderBytes ? 0 : load<std::uint64_t>(value.data() + 16);
}

std::string range(std::uint64_t first, std::uint64_t end) {
  return std::to_string(first) + " to " + std::to_string(end - 1);
}

}  // namespace

std::vector<Snapshot::Usage> Snapshot::usage() const {
  static constexpr const char* kNames[] = {"meta", "clips", "", "columns", "blobs"};
  std::vector<Usage> usage;
  const auto add = [](Usage& to, const ReadTransaction::Entry& entry) {
    ++to.records;
    to.stored_bytes += bytes_on_disk(entry);
    to.raw_bytes += stated_raw_bytes(entry.value);
  };
  std::array<Usage, kStreams> streams{Usage{"frames"}, Usage{"flow"}, Usage{"average"}};
  for (const auto& entry : impl_->txn.entries(Table::kTiles)) {
    const std::size_t stream =
        entry.key.size() == kTileKeyBytes ? static_cast<std::size_t>(entry.key[4]) : kStreams;
    if (stream < kStreams) add(streams[stream], entry);
  }
  usage.insert(usage.end(), streams.begin(), streams.end());
  for (const Table table : {Table::kColumns, Table::kBlobs, Table::kClips, Table::kMeta}) {
    Usage sum{kNames[static_cast<std::size_t>(table)]};
    for (const auto& entry : impl_->txn.entries(table)) add(sum, entry);
    usage.push_back(std::move(sum));
  }
  Usage file{"file"};
  for (const Usage& part : usage) {
    file.records += part.records;
    file.raw_bytes += part.raw_bytes;
  }
  file.stored_bytes = impl_->txn.environment().file_bytes();
  usage.push_back(std::move(file));
  return usage;
}

std::vector<std::string> Snapshot::verify() const {
  const Impl& impl = *impl_;
  std::vector<std::string> faults;
  for (const auto& [id, fault] : impl.damaged) faults.push_back(fault);
  const auto noting = [&faults](const auto& check) {
    try {
      check();
    } catch (const Error& error) {
      faults.emplace_back(error.what());
    }
  };

  // Every tile of every record, on all threads.
  const auto entries = impl.txn.entries(Table::kTiles);
  std::vector<std::vector<std::string>> found(entries.size());
  std::vector<std::uint32_t> counts(entries.size(), 0);
  tbb::parallel_for(std::size_t{0}, entries.size(), [&](std::size_t i) {
    const ByteSpan key = entries[i].key;
    const RecordPlace place = impl.txn.place(Table::kTiles, key);
    try {
      if (key.size() != kTileKeyBytes || static_cast<std::size_t>(key[4]) >= kStreams) {
        throw_damaged(place, "the key is garbled");
      }
      const TileRecord record(place, entries[i].value);
      counts[i] = record.count();
      const ClipId id{load_big_endian(key.data())};
      if (impl.damaged.contains(id)) return;
      if (!impl.records.contains(id)) throw_damaged(place, "the record belongs to no clip");
      const TileGrid& grid = impl.grid(id, static_cast<Stream>(key[4]));
      const std::uint64_t first = load_big_endian(key.data() + 5);
      if (first + record.count() > grid.tile_count())
        throw_damaged(place, "the record has more tiles than the clip");
      thread_local Bytes samples;
      for (std::uint32_t t = 0; t < record.count(); ++t) {
        try {
          const TileBox box = grid.box(static_cast<std::uint32_t>(first + t));
          samples.resize(box.bytes());
          if (!decode_tile(box, record.tile(place, t), samples)) {
            throw_damaged(place, "tile " + std::to_string(first + t) + " does not decode");
          }
        } catch (const Error& error) {
          found[i].emplace_back(error.what());
        }
      }
    } catch (const Error& error) {
      found[i].emplace_back(error.what());
    }
  });
  for (auto& lines : found) faults.insert(faults.end(), lines.begin(), lines.end());

  // No tile missing and none twice. A record that cannot be read has been named above and stands for the gap.
  std::size_t at = 0;
  for (const auto& [id, clip] : impl.records) {
    for (std::size_t s = 0; s < kStreams; ++s) {
      const Bytes first_key = tile_key(id, static_cast<Stream>(s), 0);
      const ByteSpan prefix = ByteSpan(first_key).first(5);
      while (at < entries.size() && std::ranges::lexicographical_compare(entries[at].key, prefix)) ++at;
      std::uint64_t expected = 0;
      bool unread = false;
      const auto gap = [&](std::uint64_t next) {
        if (next == expected || (unread && next > expected)) return;
        const RecordPlace place = impl.txn.place(Table::kTiles, first_key);
        noting([&] {
          throw_damaged(place, next > expected ? "tiles " + range(expected, next) + " are missing"
                                               : "tiles " + range(next, expected) + " are there twice");
        });
      };
      for (; at < entries.size() && entries[at].key.size() == kTileKeyBytes &&
             std::equal(prefix.begin(), prefix.end(), entries[at].key.begin());
           ++at) {
        const std::uint64_t first = load_big_endian(entries[at].key.data() + 5);
        gap(first);
        expected = first + counts[at];
        unread = counts[at] == 0;
      }
      gap(clip.grids[s].tile_count());
    }
  }

  // Columns and blobs, whole.
  const auto check_array = [&](Table table, const Bytes& prefix) {
    noting([&] {
      const auto chunks = impl.chunks(table, prefix);
      if (!chunks) return;
      Bytes bytes(chunks->total_bytes);
      impl.decode_chunks(table, *chunks, bytes);
    });
  };
  for (const auto& [id, clip] : impl.records) {
    noting([&] {
      for (const std::string& name : impl.column_names(id)) {
        check_array(Table::kColumns, column_prefix(id, name));
      }
    });
  }
  noting([&] {
    for (const std::string& name : impl.blob_names()) check_array(Table::kBlobs, blob_prefix(name));
  });
  return faults;
}

}  // namespace freshet::store
