#include "store/rewrite/salvage.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <tuple>
#include <utility>

#include "freshet/error.h"
#include "platform/standard_descriptors.h"
#include "store/file_locks.h"
#include "store/format/lmdb_layout.h"
#include "store/records/identity.h"
#include "store/records/tile_record.h"

namespace freshet::store {
namespace {

using namespace lmdb;

constexpr std::size_t kSlab = 1 << 20, kMaxSettingsBytes = 64 << 20;

[[noreturn]] void throw_unreadable(const std::filesystem::path& file, int code) {
  throw Error(
      ErrorKind::kIo, file.string(), std::string("cannot be read (") + std::strerror(code) + ")",
      "Where the disk itself fails, copy what it still gives to a sound one first (ddrescue), and repair "
      "the copy");
}

/// A file in memory. No writer may begin as long as it lives.
struct Map {
  Map(const std::filesystem::path& path) : file(path) {
    const StandardDescriptors standing_in;
    fd = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0)
      throw Error(ErrorKind::kInput, file.string(),
                  std::string("cannot be opened (") + std::strerror(errno) + ")",
                  "Check the name and the permissions");
    struct stat status {};
    if (fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) {
      ::close(fd);
      throw Error(ErrorKind::kInput, file.string(), "is not a file", "Give a file made by freshet ingest");
    }
    size = static_cast<std::size_t>(status.st_size);
    if (lock_byte(fd, kUserByte, F_RDLCK) && lock_byte(fd, kUnlockedReaderByte, F_RDLCK) &&
        !others_hold(fd, kWriterByte))
      return;
    ::close(fd);
    throw Error(ErrorKind::kIo, file.string(), "another process is writing to it",
                "Wait for it and run again");
  }
  ~Map() {
    if (data != nullptr) munmap(const_cast<std::byte*>(data), size);
    ::close(fd);
  }
  Map(const Map&) = delete;
  Map& operator=(const Map&) = delete;

  /// Reads all of it once: what the disk cannot give is an error here, and would be a signal in the map.
  void read(const Job& job) {
    Bytes slab(kSlab);
    for (std::size_t at = 0; at < size;) {
      if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, file.string(), "stopped");
      if (job.progress) job.progress({"reading (MiB)", at >> 20, size >> 20});
      const ssize_t got = pread(fd, slab.data(), slab.size(), static_cast<off_t>(at));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) throw_unreadable(file, errno);
      if (got == 0) throw Error(ErrorKind::kIo, file.string(), "has been cut while it was read", "Run again");
      at += static_cast<std::size_t>(got);
    }
    if (size == 0) return;
    void* const mapped = mmap(nullptr, size, PROT_READ, MAP_SHARED, fd, 0);
    if (mapped == MAP_FAILED) throw_unreadable(file, errno);
    data = static_cast<const std::byte*>(mapped);
  }

  std::filesystem::path file;
  int fd = -1;
  std::size_t size = 0;
  const std::byte* data = nullptr;
};

class Search {
 public:
  Search(std::shared_ptr<Map> map, const Job& job)
      : map_(std::move(map)), job_(job), hash_budget_(4 * std::uint64_t{map_->size} + (64 << 20)) {
    found_.contents.file = map_->file;
    found_.contents.held = map_;
    for (const std::size_t at : {std::size_t{40}, kPage + 40})  // as one of the meta pages says
      if (at + 4 <= map_->size)
        if (const auto bytes = load<std::uint32_t>(map_->data + at);
            bytes >= 512 && bytes <= 65536 && (bytes & (bytes - 1)) == 0) {
          page_ = bytes;
          break;
        }
  }

  Salvage run() {
    mark_reachable();
    find_identity();
    for (std::size_t page = 2; page < pages(); ++page) {
      if (page % 1024 == 0) {
        if (job_.stop.stop_requested()) throw Error(ErrorKind::kCancelled, map_->file.string(), "stopped");
        if (job_.progress) job_.progress({"looking for records (MiB)", page * page_ >> 20, map_->size >> 20});
      }
      each_entry(page, [&](ByteSpan key, ByteSpan value) { take(key, value, reachable_[page]); });
    }
    settle();
    return std::move(found_);
  }

 private:
  static constexpr std::size_t kPage = 4096;
  using Entry = Contents::Entry;
  struct Version {
    ByteSpan key, value;
    bool reachable;
  };
  struct ByKey {
    using is_transparent = void;
    bool operator()(ByteSpan a, ByteSpan b) const { return std::ranges::lexicographical_compare(a, b); }
  };

  std::size_t pages() const { return map_->size / page_; }
  const std::byte* page_at(std::size_t page) const { return map_->data + page * page_; }

  // The entries of what may be a page of keys; anything that could not stand there is passed over.
  template <class Visit>
  void each_node(std::size_t page, const Visit& visit) const {
    const std::byte* at = page_at(page);
    const std::size_t lower = load<std::uint16_t>(at + 12), upper = load<std::uint16_t>(at + 14);
    if (lower < kPageHeader || lower % 2 != 0 || lower > upper || upper > page_) return;
    for (std::size_t i = kPageHeader; i < lower; i += 2) {
      const std::size_t place = load<std::uint16_t>(at + i);
      if (place < upper || place + kNodeHeader > page_) continue;
      const std::byte* node = at + place;
      const std::size_t key_bytes = load<std::uint16_t>(node + 6);
      if (key_bytes > kMaxKey || place + kNodeHeader + key_bytes > page_) continue;
      visit(node, ByteSpan(node + kNodeHeader, key_bytes), page_ - place - kNodeHeader - key_bytes);
    }
  }

  template <class Visit>
  void each_entry(std::size_t page, const Visit& visit) const {
    each_node(page, [&](const std::byte* node, ByteSpan key, std::size_t left) {
      const std::uint64_t bytes = load<std::uint16_t>(node) | std::uint64_t{load<std::uint16_t>(node + 2)}
                                                                  << 16;
      // By its size, whatever its flag says.
      if (kNodeHeader + key.size() + bytes <= max_node(page_)) {
        if (bytes <= left) visit(key, ByteSpan(key.data() + key.size(), bytes));
      } else if (left >= sizeof(std::uint64_t)) {
        const auto first = load<std::uint64_t>(key.data() + key.size());
        if (first < pages() && first * page_ + kPageHeader + bytes <= map_->size)
          visit(key, ByteSpan(page_at(first) + kPageHeader, bytes));
      }
    });
  }

  // Leaves that the newest whole meta page leads to, as far as the branches are whole.
  void mark_reachable() {
    reachable_.assign(pages(), false);
    std::uint64_t newest = 0, root = kNoPage;
    for (std::size_t meta = 0; meta < 2 && (meta + 1) * page_ <= map_->size; ++meta) {
      const std::byte* at = page_at(meta);
      const auto transaction = load<std::uint64_t>(at + 144);
      if (load<std::uint32_t>(at + 16) != kMagic || transaction < newest) continue;
      newest = transaction;
      root = load<std::uint64_t>(at + 88 + 40);
    }
    std::vector<std::uint64_t> open{root};
    std::vector<bool> seen(pages(), false);
    while (!open.empty()) {
      const std::uint64_t page = open.back();
      open.pop_back();
      if (page < 2 || page >= pages() || seen[page]) continue;
      seen[page] = true;
      const auto kind = load<std::uint16_t>(page_at(page) + 10);
      if (kind == kLeaf) reachable_[page] = true;
      each_node(page, [&](const std::byte* node, ByteSpan key, std::size_t left) {
        if (kind == kBranch)
          open.push_back(load<std::uint32_t>(node) | std::uint64_t{load<std::uint16_t>(node + 4)} << 32);
        else if (kind == kLeaf && load<std::uint16_t>(node + 4) == kSubTree && left >= kTreeBytes)
          open.push_back(load<std::uint64_t>(key.data() + key.size() + 40));
      });
    }
  }

  void find_identity() {
    std::optional<std::uint64_t> id;
    bool reachable = false;
    for (std::size_t page = 2; page < pages(); ++page)
      each_entry(page, [&](ByteSpan key, ByteSpan value) {
        if (!std::ranges::equal(key, bytes_of(kIdentityKey)) || (id && (reachable || !reachable_[page])))
          return;
        if (const auto found = parse_identity(value)) {
          id = found;
          reachable = reachable_[page];
        }
      });
    if (!id)
      throw Error(
          ErrorKind::kInput, map_->file.string(),
          "is no Freshet store of this version, or its identity is lost, without which no record can be "
          "told from another store's",
          "Restore the file from a copy, or ingest its clips again into a new store");
    found_.contents.store_id = *id;
  }

  // The tables in which a key may stand.
  static bool may_stand(Table table, ByteSpan key) {
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

  void take(ByteSpan key, ByteSpan value, bool reachable) {
    if (value.size() < kRecordHeaderBytes || load<std::uint32_t>(value.data()) != kRecordMagic) return;
    // Pages that all name one huge value would be hashed without end.
    if (value.size() > hash_budget_) return;
    for (std::size_t t = 0; t < kTables; ++t) {
      const auto table = static_cast<Table>(t);
      if (!may_stand(table, key)) continue;
      auto& versions = versions_[t];
      const auto [first, last] = versions.equal_range(key);
      const auto same = std::find_if(first, last, [&](const auto& other) {
        return other.second.value.data() == value.data() && other.second.value.size() == value.size();
      });
      if (same != last) {
        same->second.reachable |= reachable;
        return;
      }
      try {
        hash_budget_ -= std::min<std::uint64_t>(hash_budget_, value.size());
        const RecordPlace at = found_.contents.place(table, key);
        if (table == Table::kTiles) {
          const TileRecord tiles(at, value);
          for (std::uint32_t i = 0; i < tiles.count(); ++i) tiles.tile(at, i);
        } else {
          open_record(at, value);
        }
        versions.emplace(key, Version{key, value, reachable});
        return;
      } catch (const Error&) {
        // Not of this table, or damaged.
      }
    }
  }

  // One version of each key.
  void settle() {
    settle_meta();
    settle_clips();
    for (const Table table : {Table::kTiles, Table::kColumns, Table::kBlobs}) {
      auto& versions = versions_[static_cast<std::size_t>(table)];
      auto& entries = found_.contents.tables[static_cast<std::size_t>(table)];
      for (auto v = versions.begin(); v != versions.end();) {
        const auto next = versions.upper_bound(v->first);
        const auto live = std::find_if(v, next, [](const auto& each) { return each.second.reachable; });
        const Version& taken = live != next ? live->second : v->second;
        entries.push_back({taken.key, taken.value});
        v = next;
      }
      if (table == Table::kBlobs) continue;
      for (const Entry& entry : entries)
        if (const ClipId id{load_big_endian(entry.key.data())}; !found_.contents.clips.contains(id))
          found_.nameless.insert(id);
    }
  }

  // What the newest of an account or of settings says: that which the trees lead to, else the last by `rank`.
  template <class Parse, class Rank>
  auto newest(Table table, ByteSpan key, std::size_t max_bytes, const Parse& parse, const Rank& rank) const {
    decltype(parse(Bytes())) best;
    bool live = false;
    const auto [first, last] = versions_[static_cast<std::size_t>(table)].equal_range(key);
    for (auto v = first; v != last; ++v) {
      try {
        auto read = parse(decode_record(found_.contents.place(table, key), v->second.value, max_bytes));
        if (!read || (best && (live || (!v->second.reachable && rank(*read) <= rank(*best))))) continue;
        best = std::move(read);
        live = v->second.reachable;
      } catch (const Error&) {
        // It does not decode.
      }
    }
    return best;
  }

  void settle_meta() {
    const auto text = newest(
        Table::kMeta, bytes_of(kSettingsKey), kMaxSettingsBytes,
        [](const Bytes& bytes) { return std::optional(bytes); }, [](const Bytes&) { return 0; });
    if (!text)
      throw_damaged(found_.contents.place(Table::kMeta, bytes_of(kSettingsKey)),
                    "the settings are lost, and with them what its clips mean");
    found_.contents.settings.assign(reinterpret_cast<const char*>(text->data()), text->size());
    const auto account = newest(
        Table::kMeta, bytes_of(kAccountKey), kMaxAccountBytes,
        [](const Bytes& bytes) { return parse_account(bytes); },
        [](const StoreAccount& a) { return a.next_clip; });
    if (!account) return;
    found_.clips = account->clips;
    found_.contents.next_clip = account->next_clip;
    found_.contents.blobs = account->blobs;
  }

  void settle_clips() {
    Contents& contents = found_.contents;
    const auto& versions = versions_[static_cast<std::size_t>(Table::kClips)];
    for (auto v = versions.begin(); v != versions.end(); v = versions.upper_bound(v->first)) {
      const ClipId id{load_big_endian(v->first.data())};
      // From a transaction that never ended.
      if (found_.clips && static_cast<std::uint32_t>(id) >= contents.next_clip) continue;
      auto clip = newest(
          Table::kClips, v->first, kMaxClipRecordBytes, [](const Bytes& bytes) { return parse_clip(bytes); },
          [](const StoredClip& c) { return c.columns.size(); });
      if (!clip) continue;
      contents.clips.emplace(id, std::move(*clip));
      contents.next_clip = std::max(contents.next_clip, static_cast<std::uint32_t>(id) + 1);
    }
  }

  std::shared_ptr<Map> map_;
  const Job& job_;
  std::uint64_t hash_budget_;
  std::size_t page_ = kPage;
  std::vector<bool> reachable_;
  std::array<std::multimap<ByteSpan, Version, ByKey>, kTables> versions_;
  Salvage found_;
};

}  // namespace

Salvage salvage(const std::filesystem::path& file, const Job& job) {
  const auto map = std::make_shared<Map>(file);
  map->read(job);
  return Search(map, job).run();
}

}  // namespace freshet::store
