#include "studio/studio_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;

/// Keeps others out until the descriptor is closed. A record lock, because the kernel says who holds it, and because a
/// command that we start does not inherit it.
int lock_folder(const fs::path& folder) {
  const fs::path path = folder / "lock";
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (fd < 0)
    throw Error(ErrorKind::kIo, path.string(), fmt::format("cannot be opened ({})", std::strerror(errno)),
                "Choose another folder with --folder");
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  if (::fcntl(fd, F_SETLK, &whole) == 0) return fd;
  const int fault = errno;
  struct flock holder = whole;
  const bool is_known = ::fcntl(fd, F_GETLK, &holder) == 0 && holder.l_type != F_UNLCK && holder.l_pid > 0;
  ::close(fd);
  if (fault == EACCES || fault == EAGAIN)
    throw Error(ErrorKind::kInput, folder.string(),
                is_known ? fmt::format("another studio has it open, process {}", holder.l_pid)
                         : "another studio has it open",
                "Use its page, stop it, or choose another folder with --folder");
  throw Error(ErrorKind::kIo, path.string(), fmt::format("cannot be locked ({})", std::strerror(fault)),
              "Choose a folder on another disk with --folder");
}

}  // namespace

void make_folder(const fs::path& folder) {
  std::error_code fault;
  fs::create_directories(folder, fault);
  if (!fs::is_directory(folder))
    throw Error(ErrorKind::kIo, folder.string(), "the studio's folder cannot be made",
                "Choose another with --folder");
}

StudioFolder::StudioFolder(const fs::path& path) {
  make_folder(path);
  path_ = fs::canonical(path);
  lock_ = lock_folder(path_);
  for (const char* name : {"projects", "stores", "incoming", "cache"}) make_folder(path_ / name);
}

StudioFolder::~StudioFolder() { ::close(lock_); }

IncomingFile StudioFolder::incoming_file() {
  return IncomingFile(path_ / "incoming" / fmt::format("{}-{}.part", ::getpid(), ++incoming_));
}

}  // namespace freshet::studio
