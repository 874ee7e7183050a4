#include "store/rewrite/store_copy.h"

#include <xxhash.h>

#include <algorithm>
#include <utility>

#include "freshet/error.h"
#include "store/records/identity.h"
#include "store/records/tile_record.h"
#include "store/rewrite/page_writer.h"

namespace freshet::store {
namespace {

class CopyRun {
 public:
  CopyRun(const StoreCopy& copy, int fd, const std::filesystem::path& file, const Job& job)
      : copy_(copy), file_(file), job_(job), counting_(fd < 0), pages_(fd, file) {
    for (const StoreCopy::Clip& clip : copy.clips) {
      StoredClip stored = clip.from->clips.at(clip.id);
      std::erase_if(stored.columns, [&](const auto& column) { return copy.without.contains(column.first); });
      for (const RecordSum& sum : stored.tiles) records_ += sum.records;
      for (const auto& [name, column] : stored.columns) records_ += column.sum.records;
      clips_.push_back(std::move(stored));
    }
    if (copy.blobs_from == nullptr) return;
    blobs_ = copy.blobs_from->blobs;
    std::erase_if(blobs_, [&](const auto& blob) { return copy.without.contains(blob.first); });
    for (const auto& [name, blob] : blobs_) records_ += blob.sum.records;
  }

  // Clips after their tiles and columns, and the account last: each says what the ones before have become.
  std::uint64_t run() {
    tiles();
    columns();
    blobs();
    clips();
    meta();
    return pages_.finish();
  }

 private:
  void tiles() {
    pages_.begin_table("tiles");
    for (std::size_t c = 0; c < clips_.size(); ++c)
      for (std::size_t s = 0; s < kStreams; ++s) {
        const auto& [from, id, as] = copy_.clips[c];
        const Bytes first = tile_key(id, static_cast<Stream>(s), 0);
        RecordSum& sum = clips_[c].tiles[s];
        const RecordSum written = std::exchange(sum, {});
        for (const auto& [key, value] : from->entries(Table::kTiles, ByteSpan(first).first(5)))
          put(*from, Table::kTiles, key, tile_key(as, static_cast<Stream>(s), load_big_endian(&key[5])),
              value, sum);
        expect_all(from->place(Table::kTiles, first), written, sum);
      }
  }

  void columns() {
    pages_.begin_table("columns");
    for (std::size_t c = 0; c < clips_.size(); ++c)
      for (auto& [name, account] : clips_[c].columns) {
        const auto& [from, id, as] = copy_.clips[c];
        array(*from, Table::kColumns, column_prefix(id, name), column_prefix(as, name), account);
      }
  }

  void blobs() {
    pages_.begin_table("blobs");
    for (auto& [name, account] : blobs_) {
      const Bytes prefix = blob_prefix(name);
      array(*copy_.blobs_from, Table::kBlobs, prefix, prefix, account);
    }
  }

  void array(const Contents& from, Table table, ByteSpan prefix, ByteSpan new_prefix, ArrayAccount& account) {
    const RecordSum written = std::exchange(account.sum, {});
    for (const auto& [key, value] : from.entries(table, prefix)) {
      Bytes to(new_prefix.begin(), new_prefix.end());
      to.insert(to.end(), key.begin() + static_cast<std::ptrdiff_t>(prefix.size()), key.end());
      put(from, table, key, to, value, account.sum);
    }
    expect_all(from.place(table, prefix), written, account.sum);
  }

  void expect_all(const RecordPlace& at, const RecordSum& written, const RecordSum& found) const {
    if (written.records != found.records)
      throw_damaged(at, std::to_string(written.records) + " records were written and " +
                            std::to_string(found.records) + " are there");
  }

  void put(const Contents& from, Table table, ByteSpan key, const Bytes& new_key, ByteSpan value,
           RecordSum& sum) {
    if (job_.stop.stop_requested()) throw Error(ErrorKind::kCancelled, file_.string(), "stopped");
    if (job_.progress && done_ % 256 == 0) job_.progress({"copying records", done_, records_});
    ++done_;
    if (counting_) {
      pages_.count(new_key, value.size());
      return sum.add(value);
    }
    const RecordPlace at = from.place(table, key);
    const Record record = open_record(at, value);
    if (from.store_id == copy_.store_id && std::ranges::equal(key, new_key)) {
      if (table == Table::kTiles) expect_tiles(at, value);
      pages_.add(new_key, value);
      return sum.add(value);
    }
    const RecordPlace to{file_, copy_.store_id, table, new_key};
    value_.assign(value.begin(), value.end());
    std::size_t hashed = record.payload.size();
    if (table == Table::kTiles) hashed = hash_tiles(at, value);
    seal_record(to, record.header, hashed, value_);
    pages_.add(new_key, value_);
    sum.add(value_);
  }

  static void expect_tiles(const RecordPlace& at, ByteSpan value) {
    const TileRecord tiles(at, value);
    for (std::uint32_t t = 0; t < tiles.count(); ++t) tiles.tile(at, t);
  }

  // The directory of value_ under the new store's id; returns its size.
  std::size_t hash_tiles(const RecordPlace& at, ByteSpan value) {
    const TileRecord tiles(at, value);
    std::byte* entry = value_.data() + kRecordHeaderBytes;
    for (std::uint32_t t = 0; t < tiles.count(); ++t, entry += kTileEntryBytes) {
      const ByteSpan tile = tiles.tile(at, t);
      const std::uint64_t hash = XXH3_64bits_withSeed(tile.data(), tile.size(), copy_.store_id);
      std::memcpy(entry + sizeof(std::uint32_t), &hash, sizeof hash);
    }
    return std::size_t{tiles.count()} * kTileEntryBytes;
  }

  void clips() {
    pages_.begin_table("clips");
    for (std::size_t c = 0; c < clips_.size(); ++c) {
      const Bytes value = put_new(Table::kClips, clip_key(copy_.clips[c].as), serialise_clip(clips_[c]));
      clips_sum_.add(value);
    }
  }

  void meta() {
    pages_.begin_table("meta");
    const StoreAccount account{.next_clip = copy_.next_clip, .clips = clips_sum_, .blobs = blobs_};
    const ByteSpan account_key = bytes_of(kAccountKey), settings_key = bytes_of(kSettingsKey);
    put_new(Table::kMeta, {account_key.begin(), account_key.end()}, serialise_account(account));
    put_new(Table::kMeta, {settings_key.begin(), settings_key.end()}, bytes_of(copy_.settings));
    pages_.add(bytes_of(kIdentityKey), encode_identity(copy_.store_id));
  }

  Bytes put_new(Table table, const Bytes& key, ByteSpan raw) {
    const Bytes value = encode_record({file_, copy_.store_id, table, key}, raw, 1, raw.size());
    pages_.add(key, value);
    return value;
  }

  const StoreCopy& copy_;
  const std::filesystem::path& file_;
  const Job& job_;
  const bool counting_;
  PageWriter pages_;
  std::vector<StoredClip> clips_;  // as they become
  ArrayAccounts blobs_;
  RecordSum clips_sum_;
  Bytes value_;
  std::size_t done_ = 0, records_ = 0;
};

}  // namespace

std::uint64_t write_copy(const StoreCopy& copy, int fd, const std::filesystem::path& file, const Job& job) {
  return CopyRun(copy, fd, file, job).run();
}

}  // namespace freshet::store
