#include "bench/harness/page_cache.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

#include "freshet/error.h"

namespace freshet::bench {

double cached_fraction(const std::filesystem::path& file) {
  const std::size_t bytes = std::filesystem::file_size(file);
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0 || bytes == 0) return 0;
  void* map = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, fd, 0);
  ::close(fd);
  if (map == MAP_FAILED) return 0;
  const std::size_t page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  std::vector<unsigned char> held((bytes + page - 1) / page);
  const bool known = mincore(map, bytes, held.data()) == 0;
  munmap(map, bytes);
  if (!known) return 0;
  const auto count = std::count_if(held.begin(), held.end(), [](unsigned char flags) { return flags & 1; });
  return static_cast<double>(count) / static_cast<double>(held.size());
}

void drop_from_cache(const std::filesystem::path& file) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) throw Error(ErrorKind::kIo, file.string(), "cannot be opened");
  fdatasync(fd);  // only clean pages are dropped
  posix_fadvise(fd, 0, 0, POSIX_FADV_DONTNEED);
  ::close(fd);
}

}  // namespace freshet::bench
