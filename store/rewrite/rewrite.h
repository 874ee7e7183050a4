// store/rewrite/rewrite.h — stores made anew out of stores: smaller, without some clips, out of several, or out of
// what is left of a damaged one.
//
// Records are copied as they lie, each with its hash checked; nothing is decoded. What takes a store's place is
// written beside it, synced, and then given its name: until then the old file stands, whatever happens.
// An index (Rebuildable) belongs to all clips of a store together, so it does not come along where they change.
#pragma once

#include <filesystem>
#include <span>

#include "freshet/job.h"
#include "store/rewrite/salvage.h"
#include "store/store.h"

namespace freshet::store {

/// Sizes of a store's file, bytes.
struct FileSizes {
  std::uint64_t before = 0, after = 0;
  std::uint64_t old_names = 0;  // more names of the file that was replaced (hard links): they have it still
};

/// What compact() would make of it. Reads keys and headers, no payload; the store may be in use.
/// Throws Error{kDamaged} where the account or a clip's record cannot be read.
FileSizes compacted_size(const std::filesystem::path& file);

/// All functions below: job's progress is "copying records"; they throw as Store::open_read (of all files read) does,
/// and Error{kDamaged} naming a damaged record, Error{kIo} for a full disk, Error{kCancelled}, Error{kUsage} for a list
/// of stores where one is meant; files are then as they were. Cost: reads and writes each record once; memory for one
/// record, and 40 bytes for each.

/// Puts the same store, rows in order, without free pages and half-filled ones, in the file's place. Nobody else may
/// have it open (Error{kIo}).
FileSizes compact(const std::filesystem::path& file, const Job& job = {});

/// The same without the clips named and without what is rebuildable; numbers of clips stay.
/// Throws also Error{kNotFound} when one of the names is no clip's.
FileSizes remove_clips(const std::filesystem::path& file, std::span<const std::string> names,
                       const Rebuildable& index, const Job& job = {});

struct MergeReport {
  std::size_t clips = 0;  // of the new store
  struct Double {
    std::string name, store;  // of the clip that was left out
    std::string kept_as;
  };
  std::vector<Double> doubles;  // clips whose source is that of a clip before
  bool index_left_out = false;
  std::uint64_t bytes = 0;
};
/// One store of the clips of several, or of lists of them, in their order; of clips from the same source, the first.
/// `out` must not exist.
/// order    names of clips that come before all others, in this order; those that are no clip's are passed over.
/// Throws also Error{kInput} when settings differ, or two clips of one name come from different sources.
MergeReport merge(std::span<const std::filesystem::path> files, const std::filesystem::path& out,
                  const Rebuildable& index, const Job& job = {}, std::span<const std::string> order = {});

/// A new store of what salvage() finds in a damaged one; clips keep their numbers, and the store its id. `out` must not
/// exist. Of a store that is whole, all is taken.
/// Throws as salvage() and merge() do.
RepairReport repair(const std::filesystem::path& file, const std::filesystem::path& out,
                    const Rebuildable& index, const Job& job = {});

}  // namespace freshet::store
