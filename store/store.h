// store/store.h — one file of clips: frames, flow, columns and indexes, read through snapshots.
//
// A store is one LMDB file. Clips are added one transaction each; a reader sees the store as it was when its
// snapshot was taken. The engine knows planes, columns and blobs of bytes, never what a pixel means.
// The bytes are laid out in docs/format.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "store/format/clip.h"

namespace freshet::store {

class Snapshot;
class ClipWriter;

/// An open store. Copies share it. One process opens a given file once at a time for writing.
///
/// Several files can be opened as one, by their names or by that of a list (store_list.h): the store that merging them
/// would make, but for its bytes. Clips are numbered through the files in their order; of clips from the same source
/// the first is there.
class Store {
 public:
  /// Creates a store file with the given settings (JSON, kept as they are; they take part in the digest).
  /// store_id   binds records to this file; drawn at random, and given only where files are to be equal byte
  ///            by byte.
  /// Throws Error{kIo} when the file exists or its folder does not.
  static Store create(const std::filesystem::path& path, const std::string& settings,
                      std::optional<std::uint64_t> store_id = {});
  /// Opens for reading. Needs no write permission, neither on the file nor on its folder.
  /// Throws Error{kInput} when there is no such file or it is no store, Error{kDamaged} when it was one.
  static Store open_read(const std::filesystem::path& path);
  /// Several as one. Throws also Error{kInput} when settings differ, or two clips of one name come from different
  /// sources: then, or when the snapshot is taken.
  static Store open_read(std::span<const std::filesystem::path> paths);
  /// Opens for reading and writing. Throws as open_read, and Error{kIo} when another process is writing.
  static Store open_write(const std::filesystem::path& path);

  const std::filesystem::path& path() const;  // of several the list's, or the first's
  Snapshot snapshot() const;

  /// Starts adding a clip: one write transaction, owned by the calling thread until commit or destruction.
  /// Throws Error{kUsage} where several files are open.
  ClipWriter add_clip();

  /// A named value of the whole store (codebook, indexes), read by Snapshot::blob.
  struct Blob {
    std::string name;
    std::span<const std::byte> bytes;
    bool in_digest = true;  // false for what cannot be reproduced bit for bit, such as a FLANN index
  };
  /// A column of one clip.
  struct Column {
    ClipId clip;
    std::string name;
    std::span<const std::byte> bytes;
    std::uint32_t element_size = 1;  // bytes
  };
  /// Erases the blobs named last, then writes or replaces blobs and columns, all in one transaction. Values
  /// are checksummed, and compressed where that makes them smaller. Nothing is borrowed beyond the call.
  /// Of several files each gets its clips' columns and all blobs, in a transaction of its own.
  ///
  /// Throws   Error{kNotFound} for a clip that is not in the store, Error{kUsage} for a name that is empty or
  ///          too long (kMaxBlobName, kMaxColumnName), for bytes that are no whole number of elements, and
  ///          for a column "patch.*" that has not the clip's rows,
  ///          Error{kIo} on a full disk. The store is then as before.
  void write(std::span<const Blob> blobs, std::span<const Column> columns = {},
             std::span<const std::string> erased_blobs = {});

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
  friend class Snapshot;
  friend class ClipWriter;
};

/// Adds one clip. Nothing is visible to others before commit(); destruction without it leaves the store as
/// it was. All calls from the thread that made it; the encoding inside runs on all threads.
class ClipWriter {
 public:
  ClipWriter(ClipWriter&&) noexcept;
  ~ClipWriter();

  /// Declares the planes of a stream; once a stream, before its first frames.
  void begin_stream(Stream stream, std::span<const PlaneShape> planes);
  /// Appends frames: frames.size() * planes views, frame-major. Any number a call; full slabs of tiles are
  /// coded and written at once, the rest is copied and kept until the next call or commit.
  void append(Stream stream, std::span<const PlaneView> planes_of_frames);

  /// A column of the clip: one value, or one fixed-size record, a row. All columns whose names begin with
  /// "patch." must have the same number of rows.
  template <class T>
  void column(std::string_view name, std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    column_bytes(name, std::as_bytes(values), sizeof(T));
  }
  void column_bytes(std::string_view name, std::span<const std::byte> bytes, std::uint32_t element_size);

  /// Fills in the streams' shapes, rows and frame_count itself. Returns when the clip is on disk.
  /// Throws Error{kIo} on a full disk: the store is then as before.
  ClipId commit(ClipRecord record);

 private:
  friend class Store;
  struct Impl;
  explicit ClipWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// The store as it was at one moment. Cheap to copy; all calls are safe from many threads.
/// Every read checks its record's header, its place and its hash, and throws Error{kDamaged}
/// naming the record.
class Snapshot {
 public:
  const std::filesystem::path& path() const;  // of the store's file or list, as it was opened
  std::vector<std::filesystem::path> files() const;
  const std::filesystem::path& file_of(ClipId id) const;
  const std::string& settings() const;
  std::span<const ClipId> clips() const;    // ascending
  const ClipRecord& clip(ClipId id) const;  // Error{kNotFound}
  std::optional<ClipId> find(std::string_view name) const;
  std::optional<ClipId> find_source(std::string_view source_hash) const;

  /// Samples of one plane: region of frames [first, first + count), frame-major, rows packed, little endian.
  /// Decodes only the tiles that the region touches, on the calling thread.
  /// out    count * region.width * region.height * bytes_per_sample bytes; overwritten.
  void read(ClipId id, Stream stream, std::uint32_t plane, Rect region, std::uint32_t first,
            std::uint32_t count, std::span<std::byte> out) const;

  /// A column of one clip; empty when the clip has no rows. Error{kNotFound} when it has no such column.
  template <class T>
  std::vector<T> column(ClipId id, std::string_view name) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values;
    column_bytes(id, name, sizeof(T), [&](std::size_t rows) {
      values.resize(rows);
      return std::as_writable_bytes(std::span<T>(values));
    });
    return values;
  }
  /// A column of records, each of `length` values: one after another.
  template <class T>
  std::vector<T> records(ClipId id, std::string_view name, std::size_t length) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values;
    column_bytes(id, name, static_cast<std::uint32_t>(length * sizeof(T)), [&](std::size_t rows) {
      values.resize(rows * length);
      return std::as_writable_bytes(std::span<T>(values));
    });
    return values;
  }
  bool has_column(ClipId id, std::string_view name) const;
  /// Rows of a column, by the records that are there and not by the clip's word. Throws as column(); reads no payload.
  std::uint64_t column_rows(ClipId id, std::string_view name) const;
  /// Bytes of a row of a column. Throws as column(); reads nothing more.
  std::uint32_t column_element(ClipId id, std::string_view name) const;
  /// Has the system fetch a column that is about to be read, and waits for nothing; of one that is not there nothing.
  /// Where a page is missed instead, it reads on for megabytes: of five million patches all 7 GB, for half a gigabyte.
  void prefetch_column(ClipId id, std::string_view name) const;
  /// Of several files nothing when they do not all have the same.
  std::optional<std::vector<std::byte>> blob(std::string_view name) const;
  std::vector<std::string> blob_names() const;  // of several files those of any

  /// Bytes on disk, by what they hold, with the number of records; file size last.
  struct Usage {
    std::string what;
    std::uint64_t records = 0, stored_bytes = 0, raw_bytes = 0;
  };
  std::vector<Usage> usage() const;

  /// One hash (32 hex digits) of all logical content: settings, clips in order of source hash with decoded
  /// streams and columns, and the blobs that take part. Independent of clip order, threads, zstd's version.
  std::string digest() const;

  /// Compares the records that are there with those that the clips and the store say there are: keys, headers,
  /// numbers, and the sums of the hashes. Reads no payload: some microseconds a record.
  /// One line a fault; empty when all is well.
  std::vector<std::string> check_account() const;

  /// Reads everything. Returns one line a damaged record; empty when all is well.
  std::vector<std::string> verify() const;

 private:
  friend class Store;
  template <class Resize>
  void column_bytes(ClipId id, std::string_view name, std::uint32_t element_size, Resize&& resize) const {
    column_into(
        id, name, element_size,
        [](void* context, std::size_t rows) { return (*static_cast<Resize*>(context))(rows); }, &resize);
  }
  void column_into(ClipId id, std::string_view name, std::uint32_t element_size,
                   std::span<std::byte> (*resize)(void*, std::size_t), void* context) const;
  struct Impl;    // of one file
  struct Joined;  // of several
  struct Place;   // a clip where it lies
  Place place(ClipId id) const;
  std::vector<const Impl*> each_file() const;
  void expect_whole() const;
  std::shared_ptr<const Impl> impl_;
  std::shared_ptr<const Joined> joined_;
};

}  // namespace freshet::store
