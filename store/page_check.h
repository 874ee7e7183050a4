// store/page_check.h — is this file an LMDB file whose B+trees can be walked without harm?
//
// LMDB 0.9 follows page numbers and offsets as they lie in the file: a cut or garbled file kills the process
// that maps it. Before a store is mapped, its meta pages, branch pages and leaf pages are read and checked
// here. The values themselves are not read; their records carry their own hashes.
#pragma once

#include <filesystem>

#include "store/format/format.h"

namespace freshet::store {

/// fd    the open file. It is only read.
/// Throws Error{kInput} when the file is no LMDB file at all, Error{kDamaged} when it was one, Error{kIo}.
/// Cost  one read a page of keys: about 60 records each, a few milliseconds for a store of some GB.
void check_pages(int fd, const std::filesystem::path& file);

}  // namespace freshet::store
