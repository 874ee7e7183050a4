#include "store/new_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

#include "freshet/error.h"
#include "platform/standard_descriptors.h"
#include "store/file_locks.h"

namespace freshet::store {

bool rename_to_new(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) return false;  // else: this file system cannot
  if (::access(to.c_str(), F_OK) == 0) {
    errno = EEXIST;
    return false;
  }
  return std::rename(from.c_str(), to.c_str()) == 0;
}

void sync_folder_of(const std::filesystem::path& file) {
  const int folder =
      ::open(file.has_parent_path() ? file.parent_path().c_str() : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  fsync(folder);
  ::close(folder);
}

std::filesystem::path unfinished_name(const std::filesystem::path& file) { return file.string() + ".making"; }

void NewFile::fail(const char* doing, int code) const {
  throw Error(ErrorKind::kIo, file_.string(), std::string(doing) + " (" + std::strerror(code) + ")",
              code == EEXIST                     ? "Choose another name, or remove it first"
              : code == ENOSPC || code == EDQUOT ? "Free space on the disk and run again"
                                                 : "Check its folder and the disk, and run again");
}

NewFile::NewFile(std::filesystem::path file, Existing existing)
    : file_(std::move(file)), unfinished_(unfinished_name(file_)), existing_(existing) {
  const StandardDescriptors standing_in;
  std::error_code unknown;
  if (existing_ == Existing::kKept &&
      std::filesystem::exists(std::filesystem::symlink_status(file_, unknown)))
    fail("cannot be made", EEXIST);
  fd_ = ::open(unfinished_.c_str(), O_RDWR | O_CREAT | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (fd_ < 0) fail("cannot be made", errno);
  struct stat here {
  }, named{};
  const bool ours = lock_byte(fd_, kUserByte, F_WRLCK) && lock_byte(fd_, kWriterByte, F_WRLCK) &&
                    fstat(fd_, &here) == 0 && ::stat(unfinished_.c_str(), &named) == 0 &&
                    here.st_ino == named.st_ino;
  if (!ours || !S_ISREG(here.st_mode)) {
    ::close(std::exchange(fd_, -1));
    throw Error(ErrorKind::kIo, file_.string(), "another process is making it", "Wait for it and run again");
  }
  listed_.emplace(unfinished_);
  if (ftruncate(fd_, 0) != 0) {  // what a killed run has left
    const int code = errno;
    ::close(std::exchange(fd_, -1));
    fail("cannot be made", code);
  }
}

NewFile::~NewFile() {
  if (fd_ < 0) return;
  if (!unfinished_.empty()) ::unlink(unfinished_.c_str());
  ::close(fd_);
}

void NewFile::commit() {
  struct stat before {};
  if (existing_ == Existing::kReplaced && ::stat(file_.c_str(), &before) == 0) {
    // Whose it is, as far as we may say.
    if (fchown(fd_, before.st_uid, before.st_gid) != 0 && errno != EPERM) fail("cannot be written", errno);
    if (fchmod(fd_, before.st_mode & 07777) != 0 && errno != EPERM) fail("cannot be written", errno);
  }
  if (fsync(fd_) != 0) fail("cannot be written", errno);
  const bool named = existing_ == Existing::kKept ? rename_to_new(unfinished_, file_)
                                                  : std::rename(unfinished_.c_str(), file_.c_str()) == 0;
  if (!named) fail("cannot be given its name", errno);
  unfinished_.clear();
  sync_folder_of(file_);
}

}  // namespace freshet::store
