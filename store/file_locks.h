// store/file_locks.h — who has a store open: locks on bytes of its file, far beyond its end.
//
// They belong to the open file (F_OFD_SETLK): they survive that LMDB or anyone else in the process opens and closes
// the same file, as ordinary POSIX locks do not, and go with the process that is killed.
#pragma once

#include <fcntl.h>
#include <sys/types.h>

namespace freshet::store {

inline constexpr off_t kUserByte = off_t{1} << 62;   // shared: has it open. Alone: replaces it
inline constexpr off_t kWriterByte = kUserByte + 1;  // writes
inline constexpr off_t kUnlockedReaderByte =
    kUserByte + 2;  // reads without LMDB's lock file: no writer may begin

/// Which of LMDB's lock files, each a byte of this range, whoever reads or writes the store is using: shared its own
/// byte, and of a writer alone all others. By another name of the store, or after its lock file was removed, there is
/// another one, in which a writer would not see the readers whose pages it uses again.
inline constexpr off_t kLockFileBytes = off_t{1} << 61, kLockFiles = off_t{1} << 61;

/// type   F_RDLCK, F_WRLCK or F_UNLCK. False when another open file stands against it.
inline bool lock_bytes(int fd, off_t first, off_t count, short type) {
  if (count == 0) return true;
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  lock.l_start = first;
  lock.l_len = count;
  return fcntl(fd, F_OFD_SETLK, &lock) == 0;
}

/// type   F_RDLCK (shared) or F_WRLCK (alone). False when another open file stands against it.
inline bool lock_byte(int fd, off_t byte, short type) { return lock_bytes(fd, byte, 1, type); }

inline bool others_hold(int fd, off_t byte) {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = byte;
  lock.l_len = 1;
  return fcntl(fd, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

}  // namespace freshet::store
