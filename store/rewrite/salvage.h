// store/rewrite/salvage.h — what can still be read of a store whose trees may be broken.
#pragma once

#include <filesystem>

#include "freshet/job.h"
#include "store/rewrite/contents.h"

namespace freshet::store {

struct RepairReport {
  struct Lost {
    ClipId id;
    std::string name, source_hash;  // empty when the clip's record is lost
    std::string fault;
  };
  std::vector<Lost> lost;               // clips that are not in the new store
  std::uint32_t unknown = 0;            // more clips of which nothing at all is left
  std::size_t clips = 0;                // of the new store
  std::vector<std::string> lost_blobs;  // that are not rebuildable
  std::vector<std::string> doubts;      // why more may be lost than can be named
  bool index_left_out = false;
  std::uint64_t bytes = 0;
  /// Whether the new store has all that the damaged one had but for the index.
  bool saved_all() const { return lost.empty() && unknown == 0 && lost_blobs.empty() && doubts.empty(); }
};

/// The clips and blobs of a damaged file that are whole, and what is to be said of the others.
struct Salvage {
  Contents contents;
  RepairReport report;  // all but `bytes`
};

/// Looks for records all over the file (record_scan.h), and trusts their hashes alone: a record that fits its key and
/// the store's id is one that was written. A clip is whole when its record's sums are those of records that were found.
/// Every whole clip is taken, also one that no tree leads to: it may be of a transaction that has not ended. What bears
/// another clip's number, name or source is named instead. Where a key has several records, one that the trees lead to
/// comes first.
///
/// The index comes along where one account of the store has the sums of all clips' records and of the index: then it
/// was written for just these clips.
///
/// job      progress "reading" and "looking for records", in MiB.
/// Throws   Error{kInput} when there is nothing of a store in it, Error{kDamaged} when its identity or its settings
///          are lost, Error{kIo} when it is being written or the disk cannot be read, Error{kCancelled}.
/// Cost     reads the file twice; some 200 bytes of memory for each record.
Salvage salvage(const std::filesystem::path& file, const Rebuildable& index, const Job& job = {});

}  // namespace freshet::store
