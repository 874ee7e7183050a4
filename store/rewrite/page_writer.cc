#include "store/rewrite/page_writer.h"

#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <utility>

#include "freshet/error.h"
#include "store/format/lmdb_layout.h"

namespace freshet::store {
namespace {

using namespace lmdb;

constexpr std::size_t kPage = 4096;  // LMDB takes any power of two, whatever the machine's own
constexpr std::size_t kBuffer = 1 << 20;
constexpr std::uint64_t kFirstMapBytes = std::uint64_t{1} << 40;  // as the engine reserves

std::size_t node_bytes(std::size_t key_bytes, std::size_t data_bytes) {
  return even(kNodeHeader + key_bytes + data_bytes);
}

template <class T>
void store_at(std::byte* at, T value) {
  std::memcpy(at, &value, sizeof value);
}

}  // namespace

void PageWriter::KeyPage::clear() {
  bytes.assign(kPage, std::byte{0});
  lower = kPageHeader;
  upper = kPage;
  entries = 0;
}

bool PageWriter::KeyPage::takes(std::size_t node) const {
  return lower + sizeof(std::uint16_t) + node <= upper;
}

std::byte* PageWriter::KeyPage::add(ByteSpan key, std::uint64_t low_48_bits, std::size_t data_bytes) {
  upper -= node_bytes(key.size(), data_bytes);
  store_at(&bytes[lower], static_cast<std::uint16_t>(upper));
  lower += sizeof(std::uint16_t);
  ++entries;
  std::byte* node = &bytes[upper];
  std::memcpy(node, &low_48_bits, 6);
  store_at(node + 6, static_cast<std::uint16_t>(key.size()));
  std::copy(key.begin(), key.end(), node + kNodeHeader);
  return node + kNodeHeader + key.size();
}

PageWriter::PageWriter(int fd, std::filesystem::path file) : fd_(fd), file_(std::move(file)) {
  page_.clear();
  const Bytes metas(2 * kPage);  // written last, where all is known
  write(metas.data(), metas.size());
}

void PageWriter::begin_table(std::string_view name) {
  end_table();
  tree_ = Tree{.name = std::string(name), .root = kNoPage};
}

void PageWriter::add(ByteSpan key, ByteSpan value) { place(key, value, value.size()); }

void PageWriter::count(ByteSpan key, std::uint64_t value_bytes) {
  assert(fd_ < 0);
  place(key, {}, value_bytes);
}

void PageWriter::place(ByteSpan key, ByteSpan value, std::uint64_t value_bytes) {
  ++tree_.entries;
  if (kNodeHeader + key.size() + value_bytes > max_node(kPage)) {
    const std::uint64_t first = write_value(value, value_bytes);
    Bytes where(sizeof first);
    store_at(where.data(), first);
    add_node(key, kBigData, value_bytes, where);
  } else {
    if (fd_ < 0 && value.empty()) {
      const Bytes nothing(value_bytes);
      return add_node(key, 0, value_bytes, nothing);
    }
    add_node(key, 0, value_bytes, value);
  }
}

// On pages of its own; returns the first one's number.
std::uint64_t PageWriter::write_value(ByteSpan value, std::uint64_t value_bytes) {
  const std::uint64_t first = next_page_, pages = pages_of(value_bytes, kPage);
  next_page_ += pages;
  tree_.overflow_pages += pages;
  if (fd_ < 0) return first;
  std::byte header[kPageHeader] = {};
  store_at(header, first);
  store_at(header + 10, kOverflow);
  store_at(header + 12, static_cast<std::uint32_t>(pages));
  write(header, sizeof header);
  write(value.data(), value.size());
  const Bytes rest(pages * kPage - sizeof header - value.size());
  write(rest.data(), rest.size());
  return first;
}

void PageWriter::add_node(ByteSpan key, std::uint16_t flags, std::uint64_t value_bytes, ByteSpan data) {
  if (!page_.takes(node_bytes(key.size(), data.size()))) end_leaf();
  if (page_.entries == 0) first_key_.assign(key.begin(), key.end());
  std::byte* at = page_.add(key, value_bytes | std::uint64_t{flags} << 32, data.size());
  std::copy(data.begin(), data.end(), at);
}

// The page in hand, under the next number.
std::uint64_t PageWriter::write_keys(std::uint16_t kind) {
  const std::uint64_t number = next_page_++;
  store_at(&page_.bytes[0], number);
  store_at(&page_.bytes[10], kind);
  store_at(&page_.bytes[12], static_cast<std::uint16_t>(page_.lower));
  store_at(&page_.bytes[14], static_cast<std::uint16_t>(page_.upper));
  write(page_.bytes.data(), page_.bytes.size());
  page_.clear();
  return number;
}

void PageWriter::end_leaf() {
  if (page_.entries == 0) return;
  ++tree_.leaf_pages;
  leaves_.push_back({std::move(first_key_), write_keys(kLeaf)});
  first_key_ = {};
}

void PageWriter::end_table() {
  end_leaf();
  std::vector<Child> level = std::exchange(leaves_, {});
  if (!level.empty()) tree_.depth = 1;
  while (level.size() > 1) {
    level = write_branches(level);
    ++tree_.depth;
  }
  if (!level.empty()) tree_.root = level.front().page;
  if (!tree_.name.empty()) tables_.push_back(tree_);
}

// One level of branches above the pages of another. The first key of a branch is never looked at and left out; a
// branch has two entries at least, so the last but one may have to give one away.
std::vector<PageWriter::Child> PageWriter::write_branches(const std::vector<Child>& below) {
  std::vector<std::size_t> starts;
  std::size_t room = 0;
  for (std::size_t i = 0; i < below.size(); ++i) {
    const std::size_t bytes = sizeof(std::uint16_t) + node_bytes(below[i].key.size(), 0);
    if (i == 0 || bytes > room) {
      starts.push_back(i);
      room = kPage - kPageHeader - sizeof(std::uint16_t) - node_bytes(0, 0);
    } else {
      room -= bytes;
    }
  }
  if (starts.back() + 1 == below.size()) --starts.back();
  std::vector<Child> above;
  starts.push_back(below.size());
  for (std::size_t b = 0; b + 1 < starts.size(); ++b) {
    for (std::size_t i = starts[b]; i < starts[b + 1]; ++i)
      page_.add(i == starts[b] ? ByteSpan() : ByteSpan(below[i].key), below[i].page, 0);
    ++tree_.branch_pages;
    above.push_back({below[starts[b]].key, write_keys(kBranch)});
  }
  return above;
}

void PageWriter::put_tree(std::byte* at, const Tree& tree, std::uint32_t pad, std::uint16_t flags) {
  store_at(at, pad);
  store_at(at + 4, flags);
  store_at(at + 6, tree.depth);
  store_at(at + 8, tree.branch_pages);
  store_at(at + 16, tree.leaf_pages);
  store_at(at + 24, tree.overflow_pages);
  store_at(at + 32, tree.entries);
  store_at(at + 40, tree.root);
}

std::uint64_t PageWriter::finish() {
  end_table();
  std::vector<Tree> tables = std::exchange(tables_, {});
  std::ranges::sort(tables, {}, &Tree::name);
  tree_ = Tree{.name = {}, .root = kNoPage};
  for (const Tree& table : tables) {
    Bytes value(kTreeBytes);
    put_tree(value.data(), table, 0, 0);
    ++tree_.entries;
    add_node(bytes_of(table.name), kSubTree, value.size(), value);
  }
  end_table();
  flush();
  const std::uint64_t pages = next_page_;
  std::uint64_t map_bytes = kFirstMapBytes;
  while (map_bytes / kPage <= 2 * pages) map_bytes *= 2;
  const Tree nothing{.name = {}, .root = kNoPage};
  // As after the first transaction: before it, in page 0, there was nothing.
  for (std::uint64_t meta = 0; meta < 2 && fd_ >= 0; ++meta) {
    Bytes page(kMetaBytes);
    store_at(&page[0], meta);
    store_at(&page[10], kMeta);
    store_at(&page[16], kMagic);
    store_at(&page[20], kVersion);
    store_at(&page[32], map_bytes);
    put_tree(&page[40], nothing, kPage, kIntegerKey | kNoSubdir);
    put_tree(&page[88], meta == 0 ? nothing : tree_, 0, 0);
    store_at(&page[136], meta == 0 ? std::uint64_t{1} : pages - 1);
    store_at(&page[144], meta);
    if (lseek(fd_, static_cast<off_t>(meta * kPage), SEEK_SET) < 0) throw_io(errno);
    write(page.data(), page.size());
    flush();
  }
  return pages * kPage;
}

void PageWriter::write(const std::byte* bytes, std::size_t size) {
  if (fd_ < 0) return;
  if (buffer_.size() + size > kBuffer) flush();
  if (size > kBuffer) {
    buffer_.assign(bytes, bytes + size);
    return flush();
  }
  buffer_.insert(buffer_.end(), bytes, bytes + size);
}

void PageWriter::throw_io(int code) const {
  throw Error(ErrorKind::kIo, file_.string(), std::string("cannot be written (") + std::strerror(code) + ")",
              "What was there is as before; free space on the disk and run again");
}

void PageWriter::flush() {
  for (std::size_t done = 0; done < buffer_.size();) {
    const ssize_t wrote = ::write(fd_, buffer_.data() + done, buffer_.size() - done);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) throw_io(wrote == 0 ? ENOSPC : errno);
    done += static_cast<std::size_t>(wrote);
  }
  buffer_.clear();
}

}  // namespace freshet::store
