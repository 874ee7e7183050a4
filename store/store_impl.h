// store/store_impl.h — what Store and Snapshot hold.
#pragma once

#include <map>
#include <vector>

#include "store/environment.h"
#include "store/records/clip_record.h"
#include "store/store.h"

namespace freshet::store {

struct Store::Impl {
  std::filesystem::path path;
  std::vector<std::shared_ptr<Environment>> files;  // one, or those that are read as one

  /// Throws Error{kUsage} where there are several.
  const std::shared_ptr<Environment>& only_file() const;
  /// As Store::write, into one of them.
  static void write(const std::shared_ptr<Environment>& file, std::span<const Blob> blobs,
                    std::span<const Column> columns, std::span<const std::string> erased_blobs);
};

struct Snapshot::Impl {
  explicit Impl(std::shared_ptr<Environment> environment);

  /// Throws Error{kNotFound}, or Error{kDamaged} when the clip's record is.
  const StoredClip& stored(ClipId id) const;
  const TileGrid& grid(ClipId id, Stream stream) const {
    return stored(id).grids[static_cast<std::size_t>(stream)];
  }
  /// Throws Error{kDamaged} when a clip's record cannot be read or one is lost: an absent name may be that
  /// clip's.
  void expect_whole() const;
  /// Throws Error{kDamaged} when the store's account of its records cannot be read.
  const StoreAccount& accounted() const;

  /// One plane of frames [first, first + count), as Snapshot::read, without the check of arguments.
  void read(ClipId id, Stream stream, std::uint32_t plane, Rect region, std::uint32_t first,
            std::uint32_t count, std::span<std::byte> out) const;

  /// Error{kNotFound} when the clip has no such column.
  const ArrayAccount& column(ClipId id, std::string_view name) const;
  /// The chunks of a column or blob put together.
  struct Chunks {
    std::uint64_t total_bytes = 0;
    std::uint32_t element_bytes = 0;
    std::uint8_t flags = 0;
    std::vector<ReadTransaction::Entry> entries;
  };
  /// Throws Error{kDamaged} when they are not those of the account.
  Chunks chunks(Table table, ByteSpan prefix, const ArrayAccount& account) const;
  void decode_chunks(Table table, const Chunks& chunks, std::span<std::byte> out) const;

  Bytes array(Table table, ByteSpan prefix, const ArrayAccount& account) const;
  std::optional<Bytes> blob(std::string_view name) const;

  std::vector<Usage> usage() const;
  std::vector<std::string> check_account() const;
  std::vector<std::string> verify() const;

  struct AccountCheck;  // account_check.cc
  struct Digest;        // digest.cc
  struct Verification;  // verify.cc

  ReadTransaction txn;
  std::string settings;
  std::vector<ClipId> clips;
  std::map<ClipId, StoredClip> records;
  std::map<ClipId, std::string> damaged;  // what is wrong with the clips that records lacks
  std::optional<StoreAccount> account;    // empty when it cannot be read
  std::string account_fault;  // what is wrong with it, or with the clips as a whole; empty: nothing
  std::map<std::string, ClipId, std::less<>> by_name, by_source;
};

struct Snapshot::Joined {
  struct Clip {
    std::size_t file;
    ClipId id;  // there
  };
  /// Throws Error{kInput} when the stores do not go together.
  Joined(std::filesystem::path path, const std::vector<std::shared_ptr<Environment>>& environments);

  std::filesystem::path path;
  std::vector<std::shared_ptr<const Impl>> files;
  std::vector<ClipId> clips;  // 0, 1, ...
  std::vector<Clip> places;   // of each
  std::map<std::string, ClipId, std::less<>> by_name, by_source;
};

struct Snapshot::Place {
  const Impl& file;
  ClipId id;
};

}  // namespace freshet::store
