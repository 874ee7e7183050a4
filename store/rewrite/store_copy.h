// store/rewrite/store_copy.h — a new store's file out of the records of others, none of them decoded.
#pragma once

#include <vector>

#include "freshet/job.h"
#include "store/rewrite/contents.h"

namespace freshet::store {

/// What a new store is to hold. Contents are borrowed.
struct StoreCopy {
  struct Clip {
    const Contents* from;
    ClipId id;  // there
    ClipId as;  // in the new store; ascending
  };
  std::uint64_t store_id = 0;
  std::string settings;
  std::uint32_t next_clip = 0;
  std::vector<Clip> clips = {};
  const Contents* blobs_from = nullptr;             // whose blobs come along; none when empty
  std::set<std::string, std::less<>> without = {};  // columns and blobs that do not
};

/// Writes it, front to back. Every record's hash is checked on the way, and made anew where the clip's number or the
/// store's id is another one; payloads stay as they are.
///
/// fd        an empty file, or -1 when only the size is asked for: nothing is read then but keys and sizes.
/// file      its name, for messages.
/// Returns   the file's size, bytes.
/// Throws    Error{kDamaged} naming the record, Error{kIo}, Error{kCancelled}.
/// Cost      one pass over the records; memory for one of them, and 40 bytes for each.
std::uint64_t write_copy(const StoreCopy& copy, int fd, const std::filesystem::path& file,
                         const Job& job = {});

}  // namespace freshet::store
