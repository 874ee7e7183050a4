// store/rewrite/page_writer.h — an LMDB file written from front to back, without LMDB.
//
// LMDB fills a file by changing trees in place: half-filled pages where keys were split, and free ones where a
// transaction left its old copies. Whoever has all entries in order needs none of that. Values and pages of keys are
// written one after another, each page as full as LMDB would let it become; what comes out is a file as after one
// transaction, the smallest with these entries, and always the same bytes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "store/format/format.h"

namespace freshet::store {

class PageWriter {
 public:
  /// fd     an empty file open for writing, or -1: nothing is written, only counted. It is not synced.
  /// file   its name, for messages.
  PageWriter(int fd, std::filesystem::path file);

  void begin_table(std::string_view name);
  /// Of the table in hand; keys (1 to 511 bytes) ascend, as bytes.
  void add(ByteSpan key, ByteSpan value);
  /// Where only the sizes are known: nothing but counting, so fd must be -1.
  void count(ByteSpan key, std::uint64_t value_bytes);
  /// Ends the last table and writes the table of tables and both meta pages. Returns the file's size, bytes.
  /// Throws, as add does, Error{kIo}.
  std::uint64_t finish();

 private:
  /// A page that has been written, or is about to be, and the least key in it.
  struct Child {
    Bytes key;
    std::uint64_t page;
  };
  struct Tree {
    std::string name;
    std::uint16_t depth = 0;
    std::uint64_t branch_pages = 0, leaf_pages = 0, overflow_pages = 0, entries = 0,
                  root = ~std::uint64_t{0};  // no page
  };
  /// A page of keys in the making; entries stand at its end, the last one lowest.
  struct KeyPage {
    Bytes bytes;
    std::size_t lower = 0, upper = 0, entries = 0;
    void clear();
    bool takes(std::size_t node_bytes) const;
    /// The place of a new entry, whose header and key are written.
    std::byte* add(ByteSpan key, std::uint64_t low_48_bits, std::size_t data_bytes);
  };

  void place(ByteSpan key, ByteSpan value, std::uint64_t value_bytes);
  std::uint64_t write_value(ByteSpan value, std::uint64_t value_bytes);
  void add_node(ByteSpan key, std::uint16_t flags, std::uint64_t value_bytes, ByteSpan data);
  std::uint64_t write_keys(std::uint16_t kind);
  void end_leaf();
  void end_table();
  std::vector<Child> write_branches(const std::vector<Child>& below);
  void write(const std::byte* bytes, std::size_t size);
  void flush();
  [[noreturn]] void throw_io(int code) const;
  static void put_tree(std::byte* at, const Tree& tree, std::uint32_t pad, std::uint16_t flags);

  int fd_;
  std::filesystem::path file_;
  std::uint64_t next_page_ = 2;
  Bytes buffer_;
  KeyPage page_;
  Bytes first_key_;  // of page_
  Tree tree_;
  std::vector<Child> leaves_;
  std::vector<Tree> tables_;
};

}  // namespace freshet::store
