// tests/store/rewrite/slow_salvage.h — the slow twin of store/rewrite/salvage.h: which clips can still be read from a
// file, found from the values' marks backwards, with no look at pages' headers, trees, or accounts.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "freshet/error.h"
#include "store/records/clip_record.h"
#include "store/records/identity.h"
#include "store/records/tile_record.h"

namespace freshet::store {

struct ReadableClip {
  std::string name, source_hash;
  auto operator<=>(const ReadableClip&) const = default;
};

class SlowSalvage {
 public:
  /// bytes     of a file with pages of 4096 bytes.
  /// without   columns that a clip can do without.
  SlowSalvage(const std::vector<char>& bytes, std::set<std::string, std::less<>> without)
      : file_(std::as_bytes(std::span(bytes))), without_(std::move(without)) {
    for (std::size_t at = 0; at + kIdentityBytes <= file_.size(); ++at)
      if (load<std::uint64_t>(&file_[at]) == load<std::uint64_t>(bytes_of(kStoreMagic).data()))
        if (const auto id = parse_identity(file_.subspan(at, kIdentityBytes))) ids_.insert(*id);
    for (std::size_t at = 0; at + 8 <= file_.size(); ++at)
      if (const auto page = load<std::uint64_t>(&file_[at]); page > 0 && page < file_.size() / 4096)
        pointers_.emplace(page, at);
    for (std::size_t at = 0; at + kRecordHeaderBytes <= file_.size(); ++at)
      if (load<std::uint32_t>(&file_[at]) == kRecordMagic) find_keys(at);
  }

  /// Those all of whose records are there.
  std::set<ReadableClip> clips() const {
    std::set<ReadableClip> readable;
    for (const auto& [place, values] : records_) {
      const auto& [id, table, key] = place;
      if (table != Table::kClips || key.size() != 4) continue;
      for (const ByteSpan value : values) {
        try {
          const RecordPlace at{kName, id, table, key};
          const auto clip = parse_clip(decode_record(at, value, kMaxClipRecordBytes));
          if (clip && is_whole(id, ClipId{load_big_endian(key.data())}, *clip))
            readable.insert({clip->record.name, clip->record.source_hash});
        } catch (const Error&) {
          // It does not decode.
        }
      }
    }
    return readable;
  }

 private:
  using Place = std::tuple<std::uint64_t, Table, Bytes>;
  static inline const std::filesystem::path kName = "slow";

  void find_keys(std::size_t at) {
    const auto stored = load<std::uint64_t>(&file_[at + 32]);
    if (stored > file_.size() - at - kRecordHeaderBytes) return;
    const ByteSpan value = file_.subspan(at, kRecordHeaderBytes + stored);
    find_key_before(at, value);
    if (at % 4096 != 16) return;
    const auto [first, last] = pointers_.equal_range(at / 4096);
    for (auto pointer = first; pointer != last; ++pointer) find_key_before(pointer->second, value);
  }

  /// An entry's key ends at `end`, and its length stands before it.
  void find_key_before(std::size_t end, ByteSpan value) {
    for (std::size_t bytes = 1; bytes <= 511 && bytes + 2 <= end; ++bytes) {
      if (load<std::uint16_t>(&file_[end - bytes - 2]) != bytes) continue;
      const ByteSpan key = file_.subspan(end - bytes, bytes);
      for (const std::uint64_t id : ids_)
        for (std::size_t t = 0; t < kTables; ++t) take(id, static_cast<Table>(t), key, value);
    }
  }

  void take(std::uint64_t id, Table table, ByteSpan key, ByteSpan value) {
    auto& known = records_[{id, table, Bytes(key.begin(), key.end())}];
    for (const ByteSpan other : known)
      if (std::ranges::equal(other, value)) return;
    try {
      const RecordPlace at{kName, id, table, key};
      open_record(at, value);
      if (table == Table::kTiles) {
        const TileRecord tiles(at, value);
        for (std::uint32_t i = 0; i < tiles.count(); ++i) tiles.tile(at, i);
      }
      known.push_back(value);
    } catch (const Error&) {
      // Not of this table, or damaged.
    }
  }

  /// Whether some versions of prefix and `at`, and so on up to `end`, add up to `wanted`.
  bool adds_up(std::uint64_t id, Table table, const Bytes& prefix, std::uint64_t at, std::uint64_t end,
               RecordSum wanted) const {
    if (at == end) return wanted == RecordSum{};
    if (wanted.records == 0) return false;
    Bytes key = prefix;
    append(key, __builtin_bswap32(static_cast<std::uint32_t>(at)));
    const auto found = records_.find({id, table, key});
    if (found == records_.end()) return false;
    return std::ranges::any_of(found->second, [&](ByteSpan value) {
      RecordSum left = wanted;
      left.subtract(value);
      return adds_up(id, table, prefix, at + (table == Table::kTiles ? load<std::uint32_t>(&value[8]) : 1),
                     end, left);
    });
  }

  bool is_whole(std::uint64_t id, ClipId number, const StoredClip& clip) const {
    for (std::size_t s = 0; s < kStreams; ++s) {
      Bytes prefix = tile_key(number, static_cast<Stream>(s), 0);
      prefix.resize(5);
      if (!adds_up(id, Table::kTiles, prefix, 0, clip.grids[s].tile_count(), clip.tiles[s])) return false;
    }
    return std::ranges::all_of(clip.columns, [&](const auto& column) {
      const auto& [name, account] = column;
      return without_.contains(name) ||
             adds_up(id, Table::kColumns, column_prefix(number, name), 0, account.sum.records, account.sum);
    });
  }

  ByteSpan file_;
  std::set<std::string, std::less<>> without_;
  std::set<std::uint64_t> ids_;
  std::multimap<std::uint64_t, std::size_t> pointers_;  // numbers of pages, and where they stand
  std::map<Place, std::vector<ByteSpan>> records_;
};

}  // namespace freshet::store
