// store/page_check.h — is this file an LMDB file of ours whose B+trees can be walked without harm?
//
// LMDB 0.9 follows page numbers, offsets and flags as they lie in the file: a cut or garbled file kills the
// process that maps it, and a writer allocates whatever the list of free pages names. Before a store is mapped,
// its meta pages, branch pages and leaf pages are read and checked here: every flag that stands where LMDB
// would not set it for us, every size, the order of keys, the counts that each tree keeps of its own pages and
// entries, and that no page is used twice or free and used at once. The values themselves are not read; their
// records carry their own hashes.
#pragma once

#include <filesystem>

#include "store/format/format.h"

namespace freshet::store {

enum class PageCheck {
  kKeys,  // pages of keys and the list of free pages
  kAll,   // also the header of every value's pages, which only a compaction or an erasure follows
};

/// fd    the open file. It is only read.
/// Throws Error{kInput} when the file is no LMDB file or no store at all, Error{kDamaged} when it was one,
///        Error{kIo}.
/// Cost   kKeys: one read a page of keys: about 60 records each, a few milliseconds for a store of some GB;
///        kAll: one more read a record. A bit of memory a page of 4 KB.
void check_pages(int fd, const std::filesystem::path& file, PageCheck depth = PageCheck::kKeys);

/// Of a value in the map: do the pages that it lies on say what LMDB needs to free them? Values that lie
/// inside a page of keys need nothing.
/// page_bytes   of the file.
/// key_bytes    of the value's key.
bool can_be_freed(std::size_t page_bytes, std::size_t key_bytes, ByteSpan value);

}  // namespace freshet::store
