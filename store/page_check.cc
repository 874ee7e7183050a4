#include "store/page_check.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "freshet/error.h"

namespace freshet::store {
namespace {

// LMDB's layout on 64-bit machines (mdb.c, 0.9.x).
constexpr std::uint32_t kLmdbMagic = 0xBEEFC0DE, kLmdbVersion = 1;
constexpr std::size_t kPageHeader = 16, kNodeHeader = 8, kTreeBytes = 48, kMetaBytes = kPageHeader + 136;
constexpr std::uint16_t kBranch = 1, kLeaf = 2, kMeta = 8;
constexpr std::uint16_t kBigData = 1, kSubTree = 2;
constexpr std::uint64_t kNoPage = ~std::uint64_t{0};
constexpr int kMaxDepth = 32;  // of LMDB's cursors
constexpr std::size_t kMaxKey = 511;

struct Tree {
  std::uint16_t depth = 0;
  std::uint64_t root = kNoPage;
  explicit Tree(const std::byte* at)
      : depth(load<std::uint16_t>(at + 6)), root(load<std::uint64_t>(at + 40)) {}
};

struct Meta {
  std::uint32_t page_bytes;
  Tree free, main;
  std::uint64_t last_page, transaction;
};

class PageWalk {
 public:
  PageWalk(int fd, const std::filesystem::path& file) : fd_(fd), file_(file) {}

  Meta live_meta() {
    struct stat status {};
    if (fstat(fd_, &status) != 0) throw_io();
    file_bytes_ = static_cast<std::uint64_t>(status.st_size);
    const Meta first = meta_at(0, true);
    const Meta second = meta_at(first.page_bytes, false);
    if (second.page_bytes != first.page_bytes) throw_damaged_file("its two meta pages disagree");
    // LMDB writes them in turn, even transactions to the first. A garbled number would bring back the past.
    const bool fresh = first.transaction == 0 && second.transaction == 0;
    const std::uint64_t apart = first.transaction > second.transaction
                                    ? first.transaction - second.transaction
                                    : second.transaction - first.transaction;
    if (!fresh && (first.transaction % 2 != 0 || second.transaction % 2 != 1 || apart != 1)) {
      throw_damaged_file("its two meta pages have transactions " + std::to_string(first.transaction) +
                         " and " + std::to_string(second.transaction) + ", expected two in a row");
    }
    return first.transaction >= second.transaction ? first : second;
  }

  void walk(const Meta& meta) {
    page_bytes_ = meta.page_bytes;
    last_page_ = meta.last_page;
    visited_ = 0;
    if (meta.last_page >= (std::uint64_t{1} << 47) / page_bytes_)
      throw_damaged_file("its last page number is absurd");
    walk_tree(meta.free, true);
    walk_tree(meta.main, false);
  }

 private:
  [[noreturn]] void throw_io() const {
    throw Error(ErrorKind::kIo, file_.string(), std::string("cannot be read (") + std::strerror(errno) + ")",
                "Check the disk and run again");
  }
  [[noreturn]] void throw_damaged_file(const std::string& fault) const {
    throw Error(ErrorKind::kDamaged, file_.string(), fault,
                "Restore the file from a copy, or ingest its clips again into a new store");
  }

  Bytes read_at(std::uint64_t offset, std::size_t bytes) const {
    Bytes buffer(bytes);
    std::size_t done = 0;
    while (done < bytes) {
      const ssize_t got = pread(fd_, buffer.data() + done, bytes - done, static_cast<off_t>(offset + done));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) throw_io();
      if (got == 0)
        throw_damaged_file("the file has been cut: byte " + std::to_string(offset + done) + " is missing");
      done += static_cast<std::size_t>(got);
    }
    return buffer;
  }

  Meta meta_at(std::uint64_t offset, bool first) const {
    const auto reject = [&](const std::string& fault) {
      if (!first) throw_damaged_file("its second meta page is garbled (" + fault + ")");
      throw Error(ErrorKind::kInput, file_.string(), "is not a Freshet store (" + fault + ")",
                  "Give a file made by freshet ingest");
    };
    if (first && file_bytes_ < kMetaBytes) reject("too short");
    const Bytes page = read_at(offset, kMetaBytes);
    if (load<std::uint32_t>(&page[16]) != kLmdbMagic) reject("no LMDB mark");
    if (load<std::uint32_t>(&page[20]) != kLmdbVersion) reject("another version of LMDB");
    if ((load<std::uint16_t>(&page[10]) & kMeta) == 0) reject("no meta page");
    const auto page_bytes = load<std::uint32_t>(&page[40]);
    if (page_bytes < 512 || page_bytes > 65536 || (page_bytes & (page_bytes - 1)) != 0) reject("page size");
    return {page_bytes, Tree(&page[40]), Tree(&page[88]), load<std::uint64_t>(&page[136]),
            load<std::uint64_t>(&page[144])};
  }

  void walk_tree(const Tree& tree, bool free_list) {
    if (tree.root == kNoPage) return;
    if (tree.depth == 0 || tree.depth > kMaxDepth)
      throw_damaged_file("a tree of depth " + std::to_string(tree.depth));
    walk_page(tree.root, tree.depth, free_list);
  }

  void check_page_number(std::uint64_t page, std::uint64_t count) const {
    if (page < 2 || page > last_page_ || count > last_page_ - page + 1) {
      throw_damaged_file("page " + std::to_string(page) + " is referred to and lies outside the store");
    }
    if ((page + count) * page_bytes_ > file_bytes_) {
      throw_damaged_file("the file has been cut: it has " + std::to_string(file_bytes_) +
                         " bytes, and page " + std::to_string(page) + " ends at " +
                         std::to_string((page + count) * page_bytes_));
    }
  }

  void walk_page(std::uint64_t number, int levels, bool free_list) {
    check_page_number(number, 1);
    if (++visited_ > last_page_) throw_damaged_file("its pages refer to each other in a circle");
    const Bytes page = read_at(number * page_bytes_, page_bytes_);
    const std::string name = "page " + std::to_string(number);
    const bool leaf = levels == 1;
    const auto flags = load<std::uint16_t>(&page[10]);
    if (load<std::uint64_t>(&page[0]) != number || (flags & 0xf) != (leaf ? kLeaf : kBranch) ||
        (flags & 0x60) != 0) {
      throw_damaged_file(name + " is not the page of keys that is expected there");
    }
    const std::size_t lower = load<std::uint16_t>(&page[12]), upper = load<std::uint16_t>(&page[14]);
    if (lower < kPageHeader || lower > upper || upper > page_bytes_)
      throw_damaged_file(name + " has garbled bounds");
    const std::size_t keys = (lower - kPageHeader) / 2;
    if (keys < (leaf || free_list ? 1u : 2u)) throw_damaged_file(name + " has too few keys");
    for (std::size_t i = 0; i < keys; ++i) {
      const std::size_t at = load<std::uint16_t>(&page[kPageHeader + 2 * i]);
      if (at < upper || at + kNodeHeader > page_bytes_) throw_damaged_file(name + " has a garbled entry");
      const std::byte* node = &page[at];
      const std::uint64_t low = load<std::uint16_t>(node), high = load<std::uint16_t>(node + 2);
      const std::uint16_t node_flags = load<std::uint16_t>(node + 4);
      const std::size_t key_bytes = load<std::uint16_t>(node + 6);
      const std::uint64_t value_bytes = low | high << 16;
      const bool inside = leaf && (node_flags & kBigData) == 0;
      const std::size_t data_bytes = !leaf ? 0 : inside ? value_bytes : 8;
      if (key_bytes > kMaxKey || at + kNodeHeader + key_bytes + data_bytes > page_bytes_) {
        throw_damaged_file(name + " has an entry that leaves it");
      }
      const std::byte* data = node + kNodeHeader + key_bytes;
      if (!leaf) {
        walk_page(low | high << 16 | std::uint64_t{node_flags} << 32, levels - 1, free_list);
      } else if (!inside) {
        check_page_number(load<std::uint64_t>(data),
                          (kPageHeader + value_bytes + page_bytes_ - 1) / page_bytes_);
      } else if ((node_flags & kSubTree) != 0) {
        if (data_bytes != kTreeBytes || free_list) throw_damaged_file(name + " has a garbled table");
        walk_tree(Tree(data), false);
      }
      if (leaf && free_list) check_free_list(node_flags, key_bytes, data, value_bytes);
    }
  }

  // LMDB allocates from these lists without a look: each is a count and that many page numbers.
  void check_free_list(std::uint16_t node_flags, std::size_t key_bytes, const std::byte* data,
                       std::uint64_t value_bytes) const {
    if (key_bytes != 8 || value_bytes < 8 || value_bytes % 8 != 0)
      throw_damaged_file("its list of free pages is garbled");
    Bytes big;
    if ((node_flags & kBigData) != 0) {
      big = read_at(load<std::uint64_t>(data) * page_bytes_ + kPageHeader, value_bytes);
      data = big.data();
    }
    const auto count = load<std::uint64_t>(data);
    if (count > value_bytes / 8 - 1) throw_damaged_file("its list of free pages is garbled");
    for (std::uint64_t i = 1; i <= count; ++i) {
      const auto page = load<std::uint64_t>(data + 8 * i);
      if (page < 2 || page > last_page_)
        throw_damaged_file("its list of free pages names page " + std::to_string(page));
    }
  }

  int fd_;
  const std::filesystem::path& file_;
  std::uint64_t file_bytes_ = 0, last_page_ = 0, visited_ = 0;
  std::size_t page_bytes_ = 0;
};

}  // namespace

void check_pages(int fd, const std::filesystem::path& file) {
  PageWalk walk(fd, file);
  // A writer in another process may commit under the walk and reuse a page: then the walk is not to be
  // believed.
  for (int attempt = 0;; ++attempt) {
    const Meta meta = walk.live_meta();
    try {
      walk.walk(meta);
      return;
    } catch (const Error&) {
      if (attempt == 20 || walk.live_meta().transaction == meta.transaction) throw;
    }
  }
}

}  // namespace freshet::store
