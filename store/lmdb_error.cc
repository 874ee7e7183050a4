#include "store/lmdb_error.h"

#include <lmdb.h>
#include <sys/statvfs.h>

#include <cerrno>

#include "freshet/error.h"
#include "platform/open_remedy.h"

namespace freshet::store {

void throw_lmdb(const std::filesystem::path& file, const std::string& doing, int code) {
  // A full disk comes out of LMDB 0.9 as EIO as often as as ENOSPC: a short write is not looked into.
  struct statvfs disk {};
  if (code == EIO && ::statvfs(file.c_str(), &disk) == 0 && disk.f_bavail == 0) code = ENOSPC;
  const std::string fault = doing + " (" + mdb_strerror(code) + ")";
  switch (code) {
    case MDB_CORRUPTED:
    case MDB_PAGE_NOTFOUND:
    case MDB_CURSOR_FULL:
    case MDB_PAGE_FULL:
    case MDB_INVALID:
    case MDB_BAD_VALSIZE:
      throw Error(ErrorKind::kDamaged, file.string(), fault,
                  "Restore the file from a copy, or ingest its clips again into a new store");
    case MDB_VERSION_MISMATCH:
      throw Error(ErrorKind::kInput, file.string(), fault,
                  "Open it with the version of Freshet that wrote it");
    case MDB_READERS_FULL:
      throw Error(ErrorKind::kIo, file.string(), fault, "Close some of the programs that read the store");
    case MDB_MAP_FULL:
    case MDB_MAP_RESIZED:
      throw Error(ErrorKind::kIo, file.string(), fault,
                  "The store is as before; raise the limit of address space (ulimit -v) and run again");
    case EACCES:
    case EPERM:
    case EROFS:
      throw Error(ErrorKind::kIo, file.string(), fault,
                  "Check the permissions of the file and of its folder");
    case ENOMEM:
      throw Error(ErrorKind::kIo, file.string(), fault, "Free memory and run again");
    default:
      throw Error(ErrorKind::kIo, file.string(), fault,
                  open_remedy(code, "The store is as before; free space on the disk and run again"));
  }
}

}  // namespace freshet::store
