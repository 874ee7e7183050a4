// platform/standard_descriptors.h — no file of ours ever becomes standard input, output or error.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

#include "freshet/error.h"

namespace freshet {

/// Where descriptors 0, 1 or 2 are closed, /dev/null stands in for them as long as this lives. In the place of standard
/// output it can only be read: who writes a result there learns that nobody gets it.
///
/// The next file that is opened gets the lowest free number. A program that was started with its stderr closed
/// (`2>&-`) would open its store as descriptor 2, and the first message of anyone in the process, be it a
/// library's, would be written over the store's first page. The executable holds one from its first line to its
/// last; rooms that open files for writing hold one while they do, for the programs that link them.
/// Throws Error{kIo} when /dev/null cannot be opened.
class StandardDescriptors {
 public:
  StandardDescriptors() {
    for (;;) {
      const int fd = ::open("/dev/null", O_RDWR);
      if (fd < 0) {
        const std::string reason = std::strerror(errno);
        release();
        throw Error(ErrorKind::kIo, "/dev/null", "cannot be opened (" + reason + ")",
                    "Close other files, and check that it exists");
      }
      if (fd > STDERR_FILENO) {
        ::close(fd);
        return;
      }
      held_[count_++] = fd;
      if (fd != STDOUT_FILENO) continue;
      const int unwritable = ::open("/dev/null", O_RDONLY);
      if (unwritable < 0) continue;
      ::dup2(unwritable, fd);
      ::close(unwritable);
    }
  }
  ~StandardDescriptors() { release(); }
  StandardDescriptors(const StandardDescriptors&) = delete;
  StandardDescriptors& operator=(const StandardDescriptors&) = delete;

 private:
  void release() {
    while (count_ > 0) ::close(held_[--count_]);
  }
  std::array<int, 3> held_{};
  std::size_t count_ = 0;
};

}  // namespace freshet
