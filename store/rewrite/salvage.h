// store/rewrite/salvage.h — what can still be read of a store whose trees may be broken.
#pragma once

#include <filesystem>

#include "freshet/job.h"
#include "store/rewrite/contents.h"

namespace freshet::store {

/// What a damaged file holds.
struct Salvage {
  Contents contents;          // every record that is whole; only the newest of several of one key
  std::set<ClipId> nameless;  // clips of which there are records, but not the one that says what they are
  std::optional<RecordSum> clips;  // what the account says of the clips' records; empty when it is lost
};

/// Looks for records on every page of the file, reachable or not, and trusts their hashes alone: a record that fits
/// its key and the store's id is one that was written. Where a key has several, that which the trees lead to is
/// taken, else, of clips, that with the most columns. The file is only read, and need not be one that opens.
///
/// job      progress "looking for records", in MiB.
/// Throws   Error{kInput} when there is nothing of a store in it, Error{kDamaged} when its identity or its settings
///          are lost, Error{kIo} when it is being written or the disk cannot be read, Error{kCancelled}.
/// Cost     reads the file twice; some 100 bytes of memory for each record.
Salvage salvage(const std::filesystem::path& file, const Job& job = {});

}  // namespace freshet::store
