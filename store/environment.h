// store/environment.h — the LMDB file: opening, locking, transactions.
//
// LMDB's own lock file guards readers against the reuse of their pages. Beside it, locks on the store itself tell
// the roles apart (file_locks.h).
#pragma once

#include <lmdb.h>

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "store/records/account.h"
#include "store/records/record.h"

namespace freshet::store {

enum class Access { kRead, kWrite };

class ReadTransaction;
class WriteTransaction;

/// Names and sources of all clips in one committed state: what a writer compares a new clip with. Reading all
/// records for it at every commit took 4.5 us per clip, and so grew with the square of their number.
struct KnownClips {
  std::size_t transaction = 0;  // number of the state; of any other, nothing is known
  std::map<std::string, std::string, std::less<>> named_by_source;
  std::set<std::string, std::less<>> names;
};

/// One open file. A process holds at most one for a given file: two would drop each other's locks.
class Environment : public std::enable_shared_from_this<Environment> {
 public:
  /// As Store::create, open_read and open_write. A store id is drawn at random where none is given.
  static std::shared_ptr<Environment> create(const std::filesystem::path& file, const std::string& settings,
                                             std::optional<std::uint64_t> store_id = {});
  static std::shared_ptr<Environment> open(const std::filesystem::path& file, Access access);
  ~Environment();
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

  const std::filesystem::path& file() const { return file_; }
  std::uint64_t store_id() const { return store_id_; }
  Access access() const { return access_; }
  int descriptor() const { return fd_; }
  std::uint64_t file_bytes() const;
  std::size_t page_bytes() const;
  RecordPlace place(Table table, ByteSpan key) const { return {file_, store_id_, table, key}; }

  /// True when no other process has the store open; keeps others from opening it until this object goes.
  bool lock_alone();

 private:
  friend class ReadTransaction;
  friend class WriteTransaction;
  Environment(std::filesystem::path file, Access access) : file_(std::move(file)), access_(access) {}
  /// at   the name that the file has while it is made; messages name file().
  void take_locks(const std::filesystem::path& at);
  void open_map(const std::filesystem::path& at);
  int try_open_map(const std::filesystem::path& at, std::size_t map_bytes, unsigned flags);
  /// Opens LMDB's environment with the largest map that there is room for, at least min_bytes. Returns LMDB's code.
  int open_largest_map(const std::filesystem::path& at, std::size_t min_bytes, unsigned flags);
  /// Throws Error{kIo} where a writer and a reader would use two lock files.
  void bind_lock_file(std::uint64_t lock_file);
  void open_tables(bool create);
  void read_identity();
  void write_identity(const std::string& settings, std::optional<std::uint64_t> store_id);
  /// A transaction, the map made larger first where another process or we need it.
  MDB_txn* begin(unsigned flags);
  /// The most of `wanted` bytes, or of half of it and so on, that can be mapped in place of the present map.
  std::size_t mappable(std::size_t wanted) const;
  void resize_map(std::size_t bytes);
  /// Throws Error{kIo} when the file has no longer the name that it was opened by: what is written into it would be
  /// lost with it, and readers that find it by another name lock another file.
  void expect_in_place() const;
  void end(MDB_txn* txn);
  /// The same for the one writer: other threads wait here, where begin_mutex_ is free.
  MDB_txn* begin_write();
  void end_write(MDB_txn* txn);
  /// Takes pages off the file's end that no committed state has: what an undone transaction has written out. The
  /// writer's.
  void cut_uncommitted();

  std::filesystem::path file_;
  std::filesystem::path at_;  // the name that it has: another one while it is made
  Access access_;
  int fd_ = -1;
  MDB_env* env_ = nullptr;
  MDB_dbi tables_[kTables] = {}, table_of_tables_ = 0;
  std::uint64_t store_id_ = 0;
  bool unlocked_reader_ = false;  // opened without LMDB's lock file
  std::size_t map_bytes_ = 0;
  std::mutex begin_mutex_;
  int transactions_ = 0;  // open ones, under begin_mutex_
  std::mutex writer_mutex_;
  std::atomic<std::thread::id> writer_thread_{};
  KnownClips known_clips_;  // the writer's alone
};

/// A consistent view. Its values stay valid and in place as long as it lives. Safe from many threads.
class ReadTransaction {
 public:
  explicit ReadTransaction(std::shared_ptr<Environment> environment);
  ~ReadTransaction();
  ReadTransaction(const ReadTransaction&) = delete;
  ReadTransaction& operator=(const ReadTransaction&) = delete;

  const Environment& environment() const { return *environment_; }
  RecordPlace place(Table table, ByteSpan key) const { return environment_->place(table, key); }

  std::optional<ByteSpan> get(Table table, ByteSpan key) const;
  struct Entry {
    ByteSpan key, value;
  };
  /// The last entry whose key is not after `key`.
  std::optional<Entry> floor(Table table, ByteSpan key) const;
  /// All entries whose keys begin with `prefix`, in order.
  std::vector<Entry> entries(Table table, ByteSpan prefix = {}) const;
  /// Has the system fetch the values of these, and nothing beside them.
  void prefetch(Table table, ByteSpan prefix) const;

 private:
  std::shared_ptr<Environment> environment_;
  MDB_txn* txn_ = nullptr;
  mutable std::mutex mutex_;  // LMDB's transactions are single-threaded; a lookup takes about a microsecond
};

/// The one writer's transaction; it belongs to the thread that made it. Destruction without commit undoes it.
/// Memory  some kMostUnwritten of values, whatever is put: the rest has been written to pages that nothing leads to
///         yet.
class WriteTransaction {
 public:
  explicit WriteTransaction(std::shared_ptr<Environment> environment);
  ~WriteTransaction();
  WriteTransaction(const WriteTransaction&) = delete;
  WriteTransaction& operator=(const WriteTransaction&) = delete;

  const Environment& environment() const { return *environment_; }
  RecordPlace place(Table table, ByteSpan key) const { return environment_->place(table, key); }

  /// Keys that come in ascending order are appended: pages are filled instead of split. A value that is there
  /// already is erased first, so that no value has more pages than it needs.
  void put(Table table, ByteSpan key, ByteSpan value);
  static constexpr std::size_t kMostUnwritten = std::size_t{64} << 20;  // bytes
  void erase(Table table, ByteSpan prefix);
  std::optional<Bytes> get(Table table, ByteSpan key) const;
  /// Calls visit(key, value) for every entry of the table.
  void each(Table table, const std::function<void(ByteSpan, ByteSpan)>& visit) const;
  void commit();

  /// Of the state that a commit makes: one more than that of the last one committed, by whatever process.
  std::size_t number() const { return mdb_txn_id(txn_); }
  KnownClips& known_clips() { return environment_->known_clips_; }

 private:
  void expect_freeable(Table table, ByteSpan key, ByteSpan value) const;
  void write_out();

  std::shared_ptr<Environment> environment_;
  MDB_txn* txn_ = nullptr;
  std::size_t unwritten_ = 0;  // bytes of values
  bool has_written_out_ = false;
};

/// The account of clips and blobs as the transaction sees it. Throws Error{kDamaged}.
StoreAccount read_account(const WriteTransaction& txn);
void put_account(WriteTransaction& txn, const StoreAccount& account);

}  // namespace freshet::store
