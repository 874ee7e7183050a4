#include "store/environment.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <map>
#include <utility>

#include "freshet/error.h"
#include "platform/standard_descriptors.h"
#include "store/file_locks.h"
#include "store/lmdb_error.h"
#include "store/new_file.h"
#include "store/page_check.h"
#include "store/records/account.h"
#include "store/records/identity.h"

namespace freshet::store {
namespace {

constexpr std::size_t kFirstMapBytes = std::size_t{1} << 40;  // reserved address space, no memory and no disk
constexpr unsigned kMaxReaders = 1024;

// The files this process has open. LMDB forbids a second environment on one file in one process.
struct OpenFiles {
  std::mutex mutex;
  std::map<std::pair<dev_t, ino_t>, std::weak_ptr<Environment>> files;
};
OpenFiles& open_files() {
  static OpenFiles files;
  return files;
}

std::pair<dev_t, ino_t> file_identity(int fd) {
  struct stat status {};
  fstat(fd, &status);
  return {status.st_dev, status.st_ino};
}

/// Empty when nothing has the name.
std::optional<std::uint64_t> inode_of(const std::string& name) {
  struct stat named {};
  if (::stat(name.c_str(), &named) != 0) return std::nullopt;
  return named.st_ino;
}

/// The name under which LMDB keeps a lock file for it: that of the file that symbolic links lead to.
std::filesystem::path name_for_locks(const std::filesystem::path& file) {
  std::error_code unknown;
  std::filesystem::path found = std::filesystem::canonical(file, unknown);
  return unknown ? file : found;
}

/// LMDB writes to its lock file through a map, which ends the process where the disk has no room for a page of it. This
/// takes the room beforehand, and is false where there is none. All other faults are left to LMDB.
bool has_room(const std::string& lock_file) {
  constexpr off_t kBytes = 128 + 64 * off_t{kMaxReaders};  // as LMDB lays it out
  const int fd = ::open(lock_file.c_str(), O_RDWR | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0666);
  if (fd < 0) return true;
  const int code = fallocate(fd, 0, 0, kBytes) == 0 ? 0 : errno;
  ::close(fd);
  return code != ENOSPC && code != EDQUOT;
}

[[noreturn]] void throw_not_created(const std::filesystem::path& file, int code) {
  throw Error(ErrorKind::kIo, file.string(), std::string("cannot be created (") + std::strerror(code) + ")",
              code == EEXIST                     ? "Choose another name, or remove it first"
              : code == ENOSPC || code == EDQUOT ? "Free space on the disk and run again"
                                                 : "Make its folder, and check that it can be written");
}

}  // namespace

std::shared_ptr<Environment> Environment::create(const std::filesystem::path& file,
                                                 const std::string& settings,
                                                 std::optional<std::uint64_t> store_id) {
  const StandardDescriptors standing_in;
  const std::shared_ptr<Environment> made(new Environment(file, Access::kWrite));
  // Made beside, and given its name when it is a store: killed at any instant, there is one or there is none.
  const std::filesystem::path fresh = unfinished_name(file);
  std::error_code unknown;
  const bool exists = std::filesystem::exists(file, unknown);
  if (!exists) made->fd_ = ::open(fresh.c_str(), O_RDWR | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0666);
  if (made->fd_ < 0) throw_not_created(file, exists ? EEXIST : errno);
  made->take_locks(fresh);
  try {
    if (ftruncate(made->fd_, 0) != 0) throw_not_created(file, errno);  // what a killed run has left
    made->open_map(fresh);
    made->open_tables(true);
    made->write_identity(settings, store_id);
    mdb_env_close(std::exchange(made->env_, nullptr));
    if (!rename_to_new(fresh, file)) throw_not_created(file, errno);
    sync_folder_of(file);
    made->open_map(name_for_locks(file));
    made->open_tables(false);
  } catch (...) {
    if (made->env_ != nullptr) mdb_env_close(std::exchange(made->env_, nullptr));
    for (const char* ending : {"", "-lock"}) ::unlink((fresh.string() + ending).c_str());
    throw;
  }
  ::unlink((fresh.string() + "-lock").c_str());
  const std::lock_guard lock(open_files().mutex);
  open_files().files[file_identity(made->fd_)] = made;
  return made;
}

std::shared_ptr<Environment> Environment::open(const std::filesystem::path& file, Access access) {
  const std::lock_guard lock(open_files().mutex);
  const StandardDescriptors standing_in;
  const int fd = ::open(file.c_str(), (access == Access::kWrite ? O_RDWR : O_RDONLY) | O_NONBLOCK |
                                          O_CLOEXEC);  // nor wait for a pipe
  if (fd < 0 && errno == EISDIR) {
    throw Error(ErrorKind::kInput, file.string(), "is not a file", "Give a file made by freshet ingest");
  }
  if (fd < 0) {
    const ErrorKind kind =
        errno == EACCES || errno == EROFS || errno == EPERM ? ErrorKind::kIo : ErrorKind::kInput;
    if (errno == EMFILE || errno == ENFILE) throw_lmdb(file, "cannot be opened", errno);
    throw Error(kind, file.string(), std::string("cannot be opened (") + std::strerror(errno) + ")",
                "Check the name and the permissions");
  }
  const std::shared_ptr<Environment> made(new Environment(file, access));
  made->fd_ = fd;
  struct stat status {};
  if (fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) {
    throw Error(ErrorKind::kInput, file.string(), "is not a file", "Give a file made by freshet ingest");
  }
  const auto identity = file_identity(fd);
  std::erase_if(open_files().files, [](const auto& entry) { return entry.second.expired(); });
  if (const auto found = open_files().files.find(identity); found != open_files().files.end()) {
    if (auto open_already = found->second.lock()) {
      if (access == Access::kRead) return open_already;
      throw Error(ErrorKind::kIo, file.string(), "is already open in this process", "Close it there first");
    }
  }
  const std::filesystem::path at = name_for_locks(file);
  made->take_locks(at);
  check_pages(fd, file);
  made->open_map(at);
  made->open_tables(false);
  made->read_identity();
  open_files().files[identity] = made;
  return made;
}

Environment::~Environment() {
  if (env_ != nullptr) mdb_env_close(env_);
  if (fd_ >= 0) ::close(fd_);
}

std::uint64_t Environment::file_bytes() const {
  struct stat status {};
  fstat(fd_, &status);
  return static_cast<std::uint64_t>(status.st_size);
}

std::size_t Environment::page_bytes() const {
  MDB_stat status{};
  mdb_env_stat(env_, &status);
  return status.ms_psize;
}

void Environment::take_locks(const std::filesystem::path& at) {
  if (!lock_byte(fd_, kUserByte, F_RDLCK)) {
    throw Error(ErrorKind::kIo, file_.string(), "is being compacted by another process",
                "Wait for it and run again");
  }
  struct stat here {
  }, named{};
  if (fstat(fd_, &here) != 0 || ::stat(at.c_str(), &named) != 0 || here.st_ino != named.st_ino) {
    throw Error(ErrorKind::kIo, file_.string(), "has been replaced while it was opened", "Run again");
  }
  if (access_ != Access::kWrite) return;
  if (!lock_byte(fd_, kWriterByte, F_WRLCK)) {
    throw Error(ErrorKind::kIo, file_.string(), "another process is writing to it",
                "Wait for it and run again");
  }
  if (others_hold(fd_, kUnlockedReaderByte)) {
    throw Error(ErrorKind::kIo, file_.string(), "a program without permission to lock it is reading it",
                "Close that program and run again");
  }
}

int Environment::try_open_map(const std::filesystem::path& at, std::size_t map_bytes, unsigned flags) {
  check_lmdb(file_, "cannot make an environment", mdb_env_create(&env_));
  mdb_env_set_maxdbs(env_, kTables + 3);
  mdb_env_set_maxreaders(env_, kMaxReaders);
  mdb_env_set_mapsize(env_, map_bytes);
  map_bytes_ = map_bytes;
  const int code = mdb_env_open(env_, at.c_str(), MDB_NOSUBDIR | MDB_NOTLS | flags, 0666);
  if (code != 0) mdb_env_close(std::exchange(env_, nullptr));
  return code;
}

int Environment::open_largest_map(const std::filesystem::path& at, std::size_t min_bytes, unsigned flags) {
  std::size_t map_bytes = kFirstMapBytes;
  int code = try_open_map(at, map_bytes, flags);
  while (code == ENOMEM && map_bytes / 2 >= min_bytes) code = try_open_map(at, map_bytes /= 2, flags);
  return code;
}

void Environment::open_map(const std::filesystem::path& at) {
  at_ = std::filesystem::absolute(at);
  const std::size_t min_bytes = std::max<std::size_t>(2 * file_bytes(), std::size_t{1} << 26);
  const unsigned flags = access_ == Access::kRead ? MDB_RDONLY : 0;
  const std::string lock_file = at.string() + "-lock";
  const bool room = has_room(lock_file);
  std::optional<std::uint64_t> before = inode_of(lock_file);
  int code = room ? open_largest_map(at, min_bytes, flags) : ENOSPC;
  // LMDB does not say which file it has opened. It is that which bore the name both before and after.
  for (int attempt = 0; code == 0; ++attempt) {
    const std::optional<std::uint64_t> after = inode_of(lock_file);
    if (after && after == before) {
      bind_lock_file(*after);
      break;
    }
    mdb_env_close(std::exchange(env_, nullptr));
    if (!after && !before && access_ == Access::kRead) {
      // On a file system that is read-only, LMDB reads without a lock file and says nothing.
      code = EROFS;
      break;
    }
    if (attempt == 20)
      throw Error(ErrorKind::kIo, file_.string(),
                  "its lock file " + lock_file + " is replaced again and again",
                  "Stop the program that does so and run again");
    before = after;
    code = open_largest_map(at, min_bytes, flags);
  }
  if ((code == EACCES || code == EPERM || code == EROFS || !room) && access_ == Access::kRead) {
    // No lock file can be made here. Pages are safe as long as nobody writes, and the locks on the store say
    // so.
    unlocked_reader_ = true;
    lock_byte(fd_, kUnlockedReaderByte, F_RDLCK);
    if (others_hold(fd_, kWriterByte)) {
      throw Error(ErrorKind::kIo, file_.string(), "is being written, and its lock file cannot be opened",
                  room ? "Get permission to write to " + file_.string() + "-lock, or wait for the writer"
                       : "Free space on the disk, or wait for the writer");
    }
    code = open_largest_map(at, min_bytes, flags | MDB_NOLOCK);
  }
  // Its pages have just been read, or written: LMDB calls it so where it gets less than it asks for.
  if (code == MDB_INVALID)
    throw Error(ErrorKind::kIo, file_.string(), "its first page could not be read whole",
                "Check the disk and run again");
  check_lmdb(file_, "cannot be opened", code);
}

void Environment::bind_lock_file(std::uint64_t lock_file) {
  const off_t own = kLockFileBytes + static_cast<off_t>(lock_file % static_cast<std::uint64_t>(kLockFiles)),
              end = kLockFileBytes + kLockFiles;
  lock_bytes(fd_, kLockFileBytes, kLockFiles, F_UNLCK);  // of the name under which it was made
  const bool alone =
      access_ == Access::kRead || (lock_bytes(fd_, kLockFileBytes, own - kLockFileBytes, F_WRLCK) &&
                                   lock_bytes(fd_, own + 1, end - own - 1, F_WRLCK));
  if (alone && lock_byte(fd_, own, F_RDLCK)) return;
  throw Error(ErrorKind::kIo, file_.string(),
              std::string("is being ") + (access_ == Access::kRead ? "written" : "read") +
                  " under another name (a hard link), or by a program whose lock file " + at_.string() +
                  "-lock was removed or replaced",
              "Wait for that program, and use one name of the store");
}

void Environment::open_tables(bool create) {
  MDB_txn* txn = begin(create ? 0 : MDB_RDONLY);  // nobody else has this object yet
  for (std::size_t t = 0; t < kTables; ++t) {
    const int code = mdb_dbi_open(txn, kTableNames[t], create ? MDB_CREATE : 0, &tables_[t]);
    if (code == 0) continue;
    mdb_txn_abort(txn);
    end(nullptr);
    if (t == 0 && (code == MDB_NOTFOUND || code == MDB_INCOMPATIBLE)) {
      throw Error(ErrorKind::kInput, file_.string(), "is an LMDB file but not a Freshet store",
                  "Give a file made by freshet ingest");
    }
    if (code == MDB_NOTFOUND || code == MDB_INCOMPATIBLE) {
      throw Error(ErrorKind::kDamaged, file_.string(), std::string("has no table \"") + kTableNames[t] + "\"",
                  "Restore the file from a copy, or ingest its clips again into a new store");
    }
    throw_lmdb(file_, "cannot open its tables", code);
  }
  const int opened = mdb_dbi_open(txn, nullptr, 0, &table_of_tables_), code = mdb_txn_commit(txn);
  end(nullptr);
  check_lmdb(file_, "cannot open its tables", opened);
  check_lmdb(file_, "cannot open its tables", code);
}

void Environment::write_identity(const std::string& settings, std::optional<std::uint64_t> store_id) {
  store_id_ = store_id ? *store_id : draw_store_id();
  WriteTransaction txn(shared_from_this());
  txn.put(Table::kMeta, bytes_of(kIdentityKey), encode_identity(store_id_));
  const RecordPlace at = place(Table::kMeta, bytes_of(kSettingsKey));
  txn.put(Table::kMeta, at.key, encode_record(at, bytes_of(settings), 1, settings.size()));
  put_account(txn, {});
  txn.commit();
}

void Environment::read_identity() {
  const ReadTransaction txn(shared_from_this());
  const RecordPlace at = place(Table::kMeta, bytes_of(kIdentityKey));
  const auto value = txn.get(Table::kMeta, at.key);
  const ByteSpan magic = bytes_of(kStoreMagic);
  if (!value || value->size() < 12 || !std::equal(magic.begin(), magic.end(), value->begin())) {
    throw Error(ErrorKind::kInput, file_.string(), "is an LMDB file but not a Freshet store",
                "Give a file made by freshet ingest");
  }
  const auto version = load<std::uint32_t>(value->data() + magic.size());
  if (version != kFormatVersion) {
    throw Error(
        ErrorKind::kInput, file_.string(),
        "has format version " + std::to_string(version) + ", expected " + std::to_string(kFormatVersion),
        version > kFormatVersion ? "Use a newer Freshet" : "Ingest its clips again with this Freshet");
  }
  const auto id = parse_identity(*value);
  if (!id) throw_damaged(at, "the store's identity is garbled");
  store_id_ = *id;
}

std::size_t Environment::mappable(std::size_t wanted) const {
  for (; wanted > map_bytes_; wanted /= 2) {
    void* const probe = mmap(nullptr, wanted, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (probe == MAP_FAILED) continue;
    munmap(probe, wanted);
    return wanted;
  }
  return map_bytes_;
}

void Environment::resize_map(std::size_t bytes) {
  // LMDB gives up its map before it makes the other: when that fails there is none, and nothing may be read or written.
  const int code = mdb_env_set_mapsize(env_, bytes);
  map_bytes_ = code == 0 ? bytes : 0;
  check_lmdb(file_, "cannot be mapped", code);
}

void Environment::expect_in_place() const {
  struct stat named {};
  if (::stat(at_.c_str(), &named) == 0 && file_identity(fd_) == std::pair(named.st_dev, named.st_ino)) return;
  throw Error(ErrorKind::kIo, file_.string(), "has been moved, replaced or removed while it was written",
              "Put it back, or run again with the name that it has now");
}

MDB_txn* Environment::begin(unsigned flags) {
  MDB_txn* txn = nullptr;
  const std::lock_guard lock(begin_mutex_);
  const bool idle = transactions_ == 0, writes = (flags & MDB_RDONLY) == 0;
  if (map_bytes_ == 0) throw_lmdb(file_, "cannot be mapped", ENOMEM);
  if (writes) {
    expect_in_place();
    if (idle && file_bytes() > map_bytes_ / 2) {
      if (const std::size_t larger = mappable(2 * map_bytes_); larger > map_bytes_) resize_map(larger);
    }
    // What a reader that died held would be kept for ever, and the file grow with every change.
    int dead = 0;
    mdb_reader_check(env_, &dead);
  }
  int code = mdb_txn_begin(env_, nullptr, flags, &txn);
  if (code == MDB_MAP_RESIZED && idle) {
    // Not as large as the other process's map: there may be less room for it here.
    resize_map(std::max(mappable(2 * file_bytes()), map_bytes_));
    code = mdb_txn_begin(env_, nullptr, flags, &txn);
  }
  if (code == MDB_READERS_FULL) {
    int dead = 0;
    mdb_reader_check(env_, &dead);
    code = mdb_txn_begin(env_, nullptr, flags, &txn);
  }
  check_lmdb(file_, "cannot begin a transaction", code);
  ++transactions_;
  return txn;
}

void Environment::end(MDB_txn* txn) {
  if (txn != nullptr) mdb_txn_abort(txn);
  const std::lock_guard lock(begin_mutex_);
  --transactions_;
}

MDB_txn* Environment::begin_write() {
  writer_mutex_.lock();
  try {
    MDB_txn* txn = begin(0);
    writer_thread_ = std::this_thread::get_id();
    return txn;
  } catch (...) {
    writer_mutex_.unlock();
    throw;
  }
}

void Environment::end_write(MDB_txn* txn) {
  end(txn);
  writer_thread_ = std::thread::id();
  writer_mutex_.unlock();
}

void Environment::cut_uncommitted() {
  MDB_envinfo info{};
  if (mdb_env_info(env_, &info) != 0) return;
  const std::uint64_t committed = (std::uint64_t{info.me_last_pgno} + 1) * page_bytes();
  // When it cannot be cut, the next transaction writes over what is there.
  if (file_bytes() > committed && ftruncate(fd_, static_cast<off_t>(committed)) != 0) return;
}

bool Environment::lock_alone() { return lock_byte(fd_, kUserByte, F_WRLCK); }

}  // namespace freshet::store
