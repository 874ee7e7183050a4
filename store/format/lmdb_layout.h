// store/format/lmdb_layout.h — how LMDB 0.9 lays out a file on 64-bit machines, for what reads or writes one by hand.
//
// A file is pages of one size. Every page begins with a header of 16 bytes: u64 its number, u16 0, u16 its kind,
// then for pages of keys u16 lower and u16 upper (the end of the entries' places, and the start of the entries), for
// the first page of a long value u32 the number of its pages. docs/format.md has the whole of it.
#pragma once

#include "store/format/format.h"

namespace freshet::store::lmdb {

inline constexpr std::uint32_t kMagic = 0xBEEFC0DE, kVersion = 1;
inline constexpr std::size_t kPageHeader = 16, kNodeHeader = 8, kTreeBytes = 48,
                             kMetaBytes = kPageHeader + 136;
inline constexpr std::uint16_t kBranch = 1, kLeaf = 2, kOverflow = 4, kMeta = 8;  // of pages
inline constexpr std::uint16_t kDirty = 16;                                       // in memory only
inline constexpr std::uint16_t kBigData = 1, kSubTree = 2;                        // of entries
inline constexpr std::uint16_t kIntegerKey = 8, kNoSubdir = 0x4000;               // of trees
inline constexpr std::uint64_t kNoPage = ~std::uint64_t{0};
inline constexpr int kMaxDepth = 32;  // of LMDB's cursors
inline constexpr std::size_t kMaxKey = 511;

/// What fits into a page of keys, header of the entry included; longer values get pages of their own.
constexpr std::size_t max_node(std::size_t page_bytes) {
  return (((page_bytes - kPageHeader) / 2) & ~std::size_t{1}) - sizeof(std::uint16_t);
}
constexpr std::size_t even(std::size_t bytes) { return (bytes + 1) & ~std::size_t{1}; }
constexpr std::uint64_t pages_of(std::uint64_t value_bytes, std::size_t page_bytes) {
  return (kPageHeader + value_bytes + page_bytes - 1) / page_bytes;
}

}  // namespace freshet::store::lmdb
