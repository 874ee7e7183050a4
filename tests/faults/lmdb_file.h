// tests/faults/lmdb_file.h — the bytes of a whole LMDB file taken apart: where its trees, pages, entries and long
// values lie. For pages of 4096 bytes.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "store/format/lmdb_layout.h"

namespace freshet::tools {

inline constexpr std::size_t kPage = 4096;
using store::lmdb::kBigData, store::lmdb::kNoPage, store::lmdb::kPageHeader, store::lmdb::kSubTree,
    store::lmdb::kTreeBytes;

/// The `bytes` low bytes of a number, at a place of a file.
std::uint64_t number_at(const std::string& file, std::size_t at, std::size_t bytes);
void put_number(std::string& file, std::size_t at, std::size_t bytes, std::uint64_t value);

struct LmdbFile {
  struct Page {
    std::string tree;
    std::size_t number;
  };
  struct Entry {
    std::string tree;
    std::size_t page, index, at;  // of the page; on it; of the entry's header in the file
    bool leaf;
    std::size_t key_bytes, value_bytes;
    std::uint16_t flags;  // kBigData: the value lies on pages of its own; kSubTree: it is a tree's record
    std::size_t value;    // where the value lies, or the number of its first page
    std::size_t key() const { return at + 8; }
    bool apart() const { return leaf && (flags & kBigData) != 0; }
    /// Of the store's own records: not of the free list, nor of the list of trees.
    bool is_record() const { return leaf && tree != "free" && tree != "main"; }
  };
  struct Apart {
    std::string tree;
    std::size_t first, count;  // pages
  };

  /// Throws std::runtime_error when a page is not of this file.
  explicit LmdbFile(std::string file);

  std::string bytes;
  std::size_t live;  // the meta page that counts: 0 or 1
  std::size_t last;  // page
  std::map<std::string, std::size_t>
      trees;  // "free", "main", and the store's tables: where their records lie
  std::vector<Page> pages;
  std::vector<Entry> entries;
  std::vector<Apart> apart;

  /// Where the bytes of a leaf's value begin.
  std::size_t value_at(const Entry& entry) const;
  std::string key_of(const Entry& entry) const { return bytes.substr(entry.key(), entry.key_bytes); }
  std::string value_of(const Entry& entry) const { return bytes.substr(value_at(entry), entry.value_bytes); }

 private:
  void walk(const std::string& tree);
  void walk_page(const std::string& tree, std::uint64_t number, std::uint64_t depth);
};

}  // namespace freshet::tools
