#include "store/page_check.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "freshet/error.h"
#include "store/format/lmdb_layout.h"

namespace freshet::store {
namespace {

using namespace lmdb;

// A tree's record, in a meta page or as a value of the main tree.
struct Tree {
  std::uint32_t pad = 0;
  std::uint16_t flags = 0, depth = 0;
  std::uint64_t branch_pages = 0, leaf_pages = 0, overflow_pages = 0, entries = 0, root = kNoPage;
  explicit Tree(const std::byte* at)
      : pad(load<std::uint32_t>(at)),
        flags(load<std::uint16_t>(at + 4)),
        depth(load<std::uint16_t>(at + 6)),
        branch_pages(load<std::uint64_t>(at + 8)),
        leaf_pages(load<std::uint64_t>(at + 16)),
        overflow_pages(load<std::uint64_t>(at + 24)),
        entries(load<std::uint64_t>(at + 32)),
        root(load<std::uint64_t>(at + 40)) {}
};

struct Meta {
  std::uint32_t page_bytes;
  Tree free, main;
  std::uint64_t address, map_bytes, last_page, transaction;
};

enum class Kind { kFree, kMain, kTable };

class PageWalk {
 public:
  PageWalk(int fd, const std::filesystem::path& file, PageCheck depth)
      : fd_(fd), file_(file), depth_(depth) {}

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
    transaction_ = meta.transaction;
    tables_.clear();
    free_.clear();
    if (meta.last_page >= (std::uint64_t{1} << 47) / page_bytes_)
      throw_damaged_file("its last page number is absurd");
    // A map at a fixed address is LMDB's to make when asked by these.
    if (meta.address != 0 || meta.map_bytes % page_bytes_ != 0 || meta.map_bytes > std::uint64_t{1} << 47 ||
        meta.map_bytes / page_bytes_ <= last_page_ || (meta.free.flags & ~kNoSubdir) != kIntegerKey) {
      throw_damaged_file("its meta page is garbled");
    }
    // Pages at the end that were freed before they were written need not be in the file.
    used_.assign(std::min(last_page_ + 1, file_bytes_ / page_bytes_), false);
    walk_tree(meta.free, Kind::kFree, "the list of free pages");
    if (meta.main.flags != 0 || meta.main.pad != 0) throw_damaged_file("its table of tables is garbled");
    walk_tree(meta.main, Kind::kMain, "the table of tables");
    walk_tables();
    for (const std::uint64_t page : free_) {
      if (page >= used_.size()) continue;
      if (used_[page]) throw_damaged_file("page " + std::to_string(page) + " is both free and in use");
      used_[page] = true;
    }
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
    if (load<std::uint32_t>(&page[16]) != kMagic) reject("no LMDB mark");
    if (load<std::uint32_t>(&page[20]) != kVersion) reject("another version of LMDB");
    if (load<std::uint16_t>(&page[10]) != kMeta || load<std::uint64_t>(&page[0]) != (first ? 0u : 1u))
      reject("no meta page");
    const auto page_bytes = load<std::uint32_t>(&page[40]);
    if (page_bytes < 512 || page_bytes > 65536 || (page_bytes & (page_bytes - 1)) != 0) reject("page size");
    return {page_bytes,
            Tree(&page[40]),
            Tree(&page[88]),
            load<std::uint64_t>(&page[24]),
            load<std::uint64_t>(&page[32]),
            load<std::uint64_t>(&page[136]),
            load<std::uint64_t>(&page[144])};
  }

  // Main's entries are exactly our tables. A file with hardly any of their names is another program's.
  void walk_tables() {
    const auto known = [](const Named& table) {
      return std::ranges::find(kTableNames, table.name) != std::end(kTableNames);
    };
    if (std::ranges::count_if(tables_, known) < 2) {
      throw Error(ErrorKind::kInput, file_.string(), "is an LMDB file but not a Freshet store",
                  "Give a file made by freshet ingest");
    }
    for (const Named& table : tables_) {
      if (!known(table)) throw_damaged_file("it has a table \"" + table.name + "\" that no store has");
      if (!table.tree || table.tree->flags != 0 || table.tree->pad != 0)
        throw_damaged_file("its table \"" + table.name + "\" is garbled");
    }
    for (const char* name : kTableNames) {
      const auto found = std::ranges::find(tables_, name, &Named::name);
      if (found == tables_.end()) throw_damaged_file(std::string("has no table \"") + name + "\"");
      walk_tree(*found->tree, Kind::kTable, "the table \"" + found->name + "\"");
    }
  }

  void walk_tree(const Tree& tree, Kind kind, const std::string& name) {
    const bool empty = tree.root == kNoPage;
    if (empty ? tree.depth != 0 : tree.depth == 0 || tree.depth > kMaxDepth)
      throw_damaged_file(name + " is a tree of depth " + std::to_string(tree.depth));
    kind_ = kind;
    name_ = &name;
    seen_ = Counts{};
    if (!empty) walk_page(tree.root, tree.depth, {}, {});
    if (tree.branch_pages != seen_.branch || tree.leaf_pages != seen_.leaf ||
        tree.overflow_pages != seen_.overflow || tree.entries != seen_.entries) {
      throw_damaged_file(name + " has " + std::to_string(seen_.entries) + " entries on " +
                         std::to_string(seen_.branch + seen_.leaf + seen_.overflow) + " pages, and says " +
                         std::to_string(tree.entries) + " on " +
                         std::to_string(tree.branch_pages + tree.leaf_pages + tree.overflow_pages));
    }
  }

  // Marks pages as used by this one reference.
  void take_pages(std::uint64_t page, std::uint64_t count) {
    if (page < 2 || page > last_page_ || count > last_page_ - page + 1) {
      throw_damaged_file("page " + std::to_string(page) + " is referred to and lies outside the store");
    }
    if ((page + count) * page_bytes_ > file_bytes_) {
      throw_damaged_file("the file has been cut: it has " + std::to_string(file_bytes_) +
                         " bytes, and page " + std::to_string(page) + " ends at " +
                         std::to_string((page + count) * page_bytes_));
    }
    for (std::uint64_t i = page; i < page + count; ++i) {
      if (used_[i]) throw_damaged_file("page " + std::to_string(i) + " is in use twice");
      used_[i] = true;
    }
  }

  // As LMDB orders them: numbers in the list of free pages, else bytes.
  bool before(ByteSpan a, ByteSpan b) const {
    if (kind_ == Kind::kFree) return load<std::uint64_t>(a.data()) < load<std::uint64_t>(b.data());
    return std::ranges::lexicographical_compare(a, b);
  }

  struct Node {
    ByteSpan key;
    const std::byte* data;
    std::uint64_t value_bytes;  // of a leaf
    std::uint64_t child;        // of a branch
    std::uint16_t flags;        // of a leaf
    std::size_t bytes;          // in the page
  };

  // The entry at `at`, which lies inside the page and has the flags that may stand there.
  Node node_at(const Bytes& page, std::size_t at, bool leaf, bool first, const std::string& name) const {
    const std::byte* node = &page[at];
    const std::uint64_t low = load<std::uint16_t>(node), high = load<std::uint16_t>(node + 2);
    const std::uint16_t flags = load<std::uint16_t>(node + 4);
    const std::size_t key_bytes = load<std::uint16_t>(node + 6);
    const std::uint64_t value_bytes = low | high << 16;
    const std::size_t data_bytes = !leaf ? 0 : (flags & kBigData) == 0 ? value_bytes : 8;
    const std::size_t bytes = kNodeHeader + key_bytes + data_bytes;
    if (key_bytes > kMaxKey || at + bytes > page_bytes_)
      throw_damaged_file(name + " has an entry that leaves it");
    // The first key of a branch is never compared and may be empty.
    if (kind_ == Kind::kFree ? key_bytes != 8 && !(first && !leaf && key_bytes == 0)
                             : key_bytes == 0 && !(first && !leaf)) {
      throw_damaged_file(name + " has a key of " + std::to_string(key_bytes) + " bytes");
    }
    if (leaf) {
      const bool allowed = flags == 0 || flags == kBigData || (flags == kSubTree && kind_ == Kind::kMain);
      const bool outside = kNodeHeader + key_bytes + value_bytes > max_node(page_bytes_);
      // LMDB may write a list of free pages twice, and leaves the shorter one where the longer one was.
      const bool shortened = kind_ == Kind::kFree && flags == kBigData;
      if (!allowed || (outside != (flags == kBigData) && !shortened)) {
        throw_damaged_file(name + " has an entry with flags " + std::to_string(flags) + " and " +
                           std::to_string(value_bytes) + " bytes, which no store has");
      }
    }
    return {{node + kNodeHeader, key_bytes},
            node + kNodeHeader + key_bytes,
            value_bytes,
            low | high << 16 | std::uint64_t{flags} << 32,
            flags,
            even(bytes)};
  }

  // The entries fill the page's end without gaps: LMDB moves them together whenever one goes.
  void expect_dense(std::vector<std::pair<std::size_t, std::size_t>>& places, std::size_t upper,
                    const std::string& name) const {
    std::ranges::sort(places);
    std::size_t expected = upper;
    for (const auto& [at, bytes] : places) {
      if (at != expected) throw_damaged_file(name + " has entries that overlap, or a gap");
      expected += bytes;
    }
    if (expected != page_bytes_) throw_damaged_file(name + " has entries that overlap, or a gap");
  }

  // low, high   what the branches above say of the page's keys: not below low, below high; empty: nothing.
  void walk_page(std::uint64_t number, int levels, ByteSpan low, ByteSpan high) {
    take_pages(number, 1);
    const Bytes page = read_at(number * page_bytes_, page_bytes_);
    const std::string name = "page " + std::to_string(number) + " (" + *name_ + ")";
    const bool leaf = levels == 1;
    if (load<std::uint64_t>(&page[0]) != number || load<std::uint16_t>(&page[10]) != (leaf ? kLeaf : kBranch))
      throw_damaged_file(name + " is not the page of keys that is expected there");
    ++(leaf ? seen_.leaf : seen_.branch);
    const std::size_t lower = load<std::uint16_t>(&page[12]), upper = load<std::uint16_t>(&page[14]);
    if (lower < kPageHeader || lower % 2 != 0 || lower > upper || upper > page_bytes_)
      throw_damaged_file(name + " has garbled bounds");
    const std::size_t keys = (lower - kPageHeader) / 2;
    if (keys < (leaf || kind_ == Kind::kFree ? 1u : 2u)) throw_damaged_file(name + " has too few keys");

    std::vector<Node> nodes;
    std::vector<std::pair<std::size_t, std::size_t>> places;
    for (std::size_t i = 0; i < keys; ++i) {
      const std::size_t at = load<std::uint16_t>(&page[kPageHeader + 2 * i]);
      if (at < upper || at % 2 != 0 || at + kNodeHeader > page_bytes_)
        throw_damaged_file(name + " has a garbled entry");
      nodes.push_back(node_at(page, at, leaf, i == 0, name));
      places.emplace_back(at, nodes.back().bytes);
      const ByteSpan least = i == (leaf ? 0u : 1u) ? low : i > 0 ? nodes[i - 1].key : ByteSpan();
      const bool strict = i > (leaf ? 0u : 1u);
      const ByteSpan key = nodes[i].key;
      if (!leaf && i == 0) continue;
      if ((!least.empty() && (before(key, least) || (strict && !before(least, key)))) ||
          (!high.empty() && !before(key, high))) {
        throw_damaged_file(name + " has keys out of order");
      }
    }
    expect_dense(places, upper, name);
    for (std::size_t i = 0; i < keys; ++i) {
      if (leaf)
        check_value(nodes[i], name);
      else
        walk_page(nodes[i].child, levels - 1, i == 0 ? low : nodes[i].key,
                  i + 1 < keys ? nodes[i + 1].key : high);
    }
  }

  void check_value(const Node& node, const std::string& name) {
    ++seen_.entries;
    if (node.flags == kBigData) {
      const auto first = load<std::uint64_t>(node.data);
      std::uint64_t count = pages_of(node.value_bytes, page_bytes_);
      if (kind_ == Kind::kFree) count = std::max<std::uint64_t>(count, stated_pages(first));
      take_pages(first, count);
      seen_.overflow += count;
      if (depth_ == PageCheck::kAll || kind_ == Kind::kFree) check_value_pages(first, count);
    }
    if (kind_ == Kind::kFree) check_free_list(node);
    if (kind_ != Kind::kMain) return;
    if (node.flags == kSubTree && node.value_bytes != kTreeBytes)
      throw_damaged_file(name + " has a garbled table");
    tables_.push_back({{reinterpret_cast<const char*>(node.key.data()), node.key.size()},
                       node.flags == kSubTree ? std::optional<Tree>(node.data) : std::nullopt});
  }

  // How many pages the header of a long value names; 0 where there is none.
  std::uint64_t stated_pages(std::uint64_t first) const {
    if (first < 2 || first > last_page_ || (first + 1) * page_bytes_ > file_bytes_) return 0;
    return load<std::uint32_t>(&read_at(first * page_bytes_, kPageHeader)[12]);
  }

  // The header of a long value's pages: LMDB frees and copies as many as it names.
  void check_value_pages(std::uint64_t first, std::uint64_t count) const {
    const Bytes header = read_at(first * page_bytes_, kPageHeader);
    if (load<std::uint64_t>(&header[0]) != first || load<std::uint16_t>(&header[10]) != kOverflow ||
        load<std::uint32_t>(&header[12]) != count) {
      throw_damaged_file("page " + std::to_string(first) + " (" + *name_ +
                         ") is not the first page of the value that is expected there");
    }
  }

  // LMDB allocates from these lists without a look: each is a count and that many page numbers, descending.
  void check_free_list(const Node& node) {
    const auto number = load<std::uint64_t>(node.key.data());
    if (number == 0 || number > transaction_ || node.value_bytes < 8 || node.value_bytes % 8 != 0)
      throw_damaged_file("its list of free pages is garbled");
    Bytes big;
    const std::byte* data = node.data;
    if (node.flags == kBigData) {
      big = read_at(load<std::uint64_t>(data) * page_bytes_ + kPageHeader, node.value_bytes);
      data = big.data();
    }
    const auto count = load<std::uint64_t>(data);
    if (count > node.value_bytes / 8 - 1) throw_damaged_file("its list of free pages is garbled");
    for (std::uint64_t i = 1; i <= count; ++i) {
      const auto page = load<std::uint64_t>(data + 8 * i);
      if (page < 2 || page > last_page_)
        throw_damaged_file("its list of free pages names page " + std::to_string(page));
      if (i > 1 && page >= free_.back()) throw_damaged_file("its list of free pages is out of order");
      free_.push_back(page);
    }
  }

  struct Named {
    std::string name;
    std::optional<Tree> tree;
  };
  struct Counts {
    std::uint64_t branch = 0, leaf = 0, overflow = 0, entries = 0;
  };

  int fd_;
  const std::filesystem::path& file_;
  PageCheck depth_;
  std::uint64_t file_bytes_ = 0, last_page_ = 0, transaction_ = 0;
  std::size_t page_bytes_ = 0;
  std::vector<bool> used_;
  std::vector<std::uint64_t> free_;
  std::vector<Named> tables_;
  // Of the tree in hand.
  Kind kind_ = Kind::kFree;
  const std::string* name_ = nullptr;
  Counts seen_;
};

}  // namespace

void check_pages(int fd, const std::filesystem::path& file, PageCheck depth) {
  PageWalk walk(fd, file, depth);
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

bool can_be_freed(std::size_t page_bytes, std::size_t key_bytes, ByteSpan value) {
  if (kNodeHeader + key_bytes + value.size() <= max_node(page_bytes)) return true;
  const std::byte* page = value.data() - kPageHeader;
  return (load<std::uint16_t>(page + 10) & ~kDirty) == kOverflow &&
         load<std::uint32_t>(page + 12) == pages_of(value.size(), page_bytes);
}

}  // namespace freshet::store
