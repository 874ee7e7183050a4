#include "store/rewrite/record_scan.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "freshet/error.h"
#include "platform/open_remedy.h"
#include "platform/standard_descriptors.h"
#include "store/file_locks.h"
#include "store/format/lmdb_layout.h"
#include "store/records/account.h"
#include "store/records/identity.h"
#include "store/records/record.h"

namespace freshet::store {
namespace {

using namespace lmdb;

constexpr std::size_t kSlab = 1 << 20;

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
                  open_remedy(errno, "Check the name and the permissions"));
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

class Scan {
 public:
  Scan(const Map& map, const Job& job) : map_(map), job_(job) {
    page_ = stated_page_bytes(0);
    if (page_ == 0 || stated_page_bytes(page_) != page_) page_ = likely_page_bytes();
  }

  RecordScan run() {
    found_.file_bytes = map_.size;
    walk_trees();
    for (std::size_t page = 0; page * page_ < map_.size; ++page) {
      if (page % 1024 == 0) {
        if (job_.stop.stop_requested()) throw Error(ErrorKind::kCancelled, map_.file.string(), "stopped");
        if (job_.progress) job_.progress({"looking for records (MiB)", page * page_ >> 20, map_.size >> 20});
      }
      const std::size_t end = std::min((page + 1) * page_, map_.size);
      for (std::size_t at = page * page_; at + kNodeHeader <= end; at += 2) take(at, end);
    }
    const auto is_live = [](const auto& each) { return each.live; };
    // Clang 14 does not compile the one of std::ranges.
    std::stable_partition(found_.entries.begin(), found_.entries.end(), is_live);
    std::stable_partition(found_.identities.begin(), found_.identities.end(), is_live);
    return std::move(found_);
  }

 private:
  std::size_t pages() const { return map_.size / page_; }
  const std::byte* page_at(std::size_t page) const { return map_.data + page * page_; }

  /// What the meta page at this place says; 0 where it says nothing of use.
  std::size_t stated_page_bytes(std::size_t at) const {
    if (at + kMetaBytes > map_.size) return 0;
    const auto bytes = load<std::uint32_t>(map_.data + at + 40);
    return bytes >= 512 && bytes <= 65536 && (bytes & (bytes - 1)) == 0 ? bytes : 0;
  }

  /// The size at which most pages begin with their numbers.
  std::size_t likely_page_bytes() const {
    std::pair<std::size_t, std::size_t> best{0, 4096};  // pages with their numbers; the size
    for (std::size_t bytes = 512; bytes <= 65536; bytes *= 2) {
      std::size_t numbered = 0;
      for (std::size_t page = 2; (page + 1) * bytes <= map_.size; ++page)
        numbered += load<std::uint64_t>(map_.data + page * bytes) == page;
      if (numbered > best.first) best = {numbered, bytes};
    }
    return best.second;
  }

  /// Notes where the entries are that the newest whole meta page leads to, as far as the branches are whole.
  void walk_trees() {
    std::array<std::uint64_t, 2> transactions{};
    std::uint64_t root = kNoPage;
    int whole = 0;
    for (std::size_t meta = 0; meta < 2 && (meta + 1) * page_ <= map_.size; ++meta) {
      const std::byte* at = page_at(meta);
      if (load<std::uint32_t>(at + 16) != kMagic || load<std::uint16_t>(at + 10) != kMeta) continue;
      ++whole;
      transactions[meta] = load<std::uint64_t>(at + 144);
      if (whole == 1 || transactions[1] > transactions[0]) root = load<std::uint64_t>(at + 88 + 40);
    }
    const auto [even, odd] = transactions;
    found_.trees_are_last =
        whole == 2 && ((even == 0 && odd == 0) ||
                       (even % 2 == 0 && odd % 2 == 1 && std::max(even, odd) - std::min(even, odd) == 1));
    std::vector<std::uint64_t> open{root};
    std::vector<bool> seen(pages(), false);
    while (!open.empty()) {
      const std::uint64_t page = open.back();
      open.pop_back();
      if (page < 2 || page >= pages() || seen[page]) continue;
      seen[page] = true;
      walk_page(page, open);
    }
    std::ranges::sort(live_);
  }

  void walk_page(std::uint64_t page, std::vector<std::uint64_t>& open) {
    const std::byte* at = page_at(page);
    const auto kind = load<std::uint16_t>(at + 10);
    const std::size_t lower = load<std::uint16_t>(at + 12), upper = load<std::uint16_t>(at + 14);
    if (load<std::uint64_t>(at) != page || lower < kPageHeader || lower % 2 != 0 || lower > upper ||
        upper > page_)
      return;
    for (std::size_t i = kPageHeader; i < lower; i += 2) {
      const std::size_t place = load<std::uint16_t>(at + i);
      if (place < upper || place + kNodeHeader > page_) continue;
      const std::byte* node = at + place;
      const std::size_t data = place + kNodeHeader + load<std::uint16_t>(node + 6);
      const auto flags = load<std::uint16_t>(node + 4);
      if (kind == kBranch)
        open.push_back(load<std::uint32_t>(node) | std::uint64_t{flags} << 32);
      else if (kind == kLeaf && flags == kSubTree && data + kTreeBytes <= page_)
        open.push_back(load<std::uint64_t>(at + data + 40));
      else if (kind == kLeaf)
        live_.push_back(page * page_ + place);
    }
  }

  /// at    where an entry may stand.
  /// end   of its page.
  void take(std::size_t at, std::size_t end) {
    const std::byte* node = map_.data + at;
    const std::size_t key_bytes = load<std::uint16_t>(node + 6);
    if (key_bytes == 0 || key_bytes > kMaxKey || at + kNodeHeader + key_bytes > end) return;
    const std::uint64_t bytes = load<std::uint32_t>(node);
    const ByteSpan key(node + kNodeHeader, key_bytes);
    const std::size_t data = at + kNodeHeader + key_bytes;
    // By its size, whatever its flag says.
    if (kNodeHeader + key_bytes + bytes <= max_node(page_)) {
      if (data + bytes <= end) take(key, ByteSpan(map_.data + data, bytes), at);
    } else if (data + sizeof(std::uint64_t) <= end) {
      const auto first = load<std::uint64_t>(map_.data + data);
      if (first < pages() && first * page_ + kPageHeader + bytes <= map_.size)
        take(key, ByteSpan(page_at(first) + kPageHeader, bytes), at);
    }
  }

  void take(ByteSpan key, ByteSpan value, std::size_t at) {
    if (value.size() >= kRecordHeaderBytes && load<std::uint32_t>(value.data()) == kRecordMagic) {
      found_.entries.push_back({key, value, is_live(at)});
    } else if (std::ranges::equal(key, bytes_of(kIdentityKey))) {
      const auto id = parse_identity(value);
      if (!id) return;
      const auto same = std::ranges::find(found_.identities, *id, &RecordScan::Identity::store_id);
      if (same == found_.identities.end())
        found_.identities.push_back({*id, is_live(at)});
      else
        same->live |= is_live(at);
    }
  }
  bool is_live(std::size_t at) const { return std::ranges::binary_search(live_, at); }

  const Map& map_;
  const Job& job_;
  std::size_t page_ = 4096;
  std::vector<std::size_t> live_;  // places of entries in the file, ascending
  RecordScan found_;
};

}  // namespace

RecordScan scan_records(const std::filesystem::path& file, const Job& job) {
  const auto map = std::make_shared<Map>(file);
  map->read(job);
  RecordScan found = Scan(*map, job).run();
  found.held = map;
  return found;
}

}  // namespace freshet::store
