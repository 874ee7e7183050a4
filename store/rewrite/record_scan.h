// store/rewrite/record_scan.h — every entry of a file that may be a record, whether anything leads to it or not.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "freshet/job.h"
#include "store/format/format.h"

namespace freshet::store {

/// Borrowed from the map that `held` keeps.
struct RecordScan {
  struct Entry {
    ByteSpan key, value;
    bool live;  // the trees lead to it
  };
  struct Identity {
    std::uint64_t store_id;
    bool live;
  };
  std::uint64_t file_bytes = 0;
  std::vector<Entry> entries;  // values that begin as a record does, their hashes unchecked; live ones first
  std::vector<Identity> identities;  // of stores, each once; live ones first
  bool trees_are_last =
      false;  // both meta pages are whole: what is live is the last state that was committed
  std::shared_ptr<const void> held;
};

/// Takes every even place of the file for an entry of a page of keys, as broken pages and freed ones still hold them,
/// and keeps those whose value begins as a record or an identity does.
///
/// job      progress "reading" and "looking for records", in MiB.
/// Throws   Error{kInput} when there is no such file, Error{kIo} when it is being written or the disk cannot be read,
///          Error{kCancelled}.
/// Cost     reads the file twice; 40 bytes of memory for each entry. No writer can begin while `held` lives.
RecordScan scan_records(const std::filesystem::path& file, const Job& job);

}  // namespace freshet::store
