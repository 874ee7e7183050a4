// store/rewrite/contents.h — all that a store's file holds, as plain lists of records.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "store/environment.h"
#include "store/records/clip_record.h"

namespace freshet::store {

/// Tables as lists, ascending by key. Borrowed from the map that `held` keeps.
struct Contents {
  using Entry = ReadTransaction::Entry;

  std::filesystem::path file;
  std::uint64_t store_id = 0;
  std::string settings = {};
  std::uint32_t next_clip = 0;  // the number of the clip that would be added next
  std::map<ClipId, StoredClip> clips = {};
  ArrayAccounts blobs = {};
  std::array<std::vector<Entry>, kTables> tables = {};
  std::shared_ptr<const void> held = {};

  const std::vector<Entry>& table(Table which) const { return tables[static_cast<std::size_t>(which)]; }
  RecordPlace place(Table which, ByteSpan key) const { return {file, store_id, which, key}; }
  /// Those whose keys begin with `prefix`.
  std::span<const Entry> entries(Table which, ByteSpan prefix) const;
};

/// Of an open store. Throws Error{kDamaged} where settings, account or a clip's record cannot be read, or are not
/// all there; tiles and columns are not looked at.
Contents read_contents(const std::shared_ptr<Environment>& environment);

/// Columns and blobs that can be made anew from all else in a store, by name.
struct Rebuildable {
  std::set<std::string, std::less<>> columns, blobs;
};

}  // namespace freshet::store
