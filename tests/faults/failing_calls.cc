// A library to be preloaded: makes the n-th call that changes a file fail, or end the process. For tests only.
//
// FRESHET_FAULT=KIND:N   KIND is enospc, eio, eintr (the call does nothing and fails), full (enospc from the n-th
//                        on), short (a write takes half), lost (a write is said to have been done and is not) or
//                        kill (SIGKILL before the call).
// FRESHET_FAULT_FILES    Only files whose path contains this.
// FRESHET_FAULT_COUNT    A file to which the number of such calls is written at the end.
//
// Calls that the C library makes inside itself (fwrite's own) do not come here.

#include <dlfcn.h>
#include <sys/mman.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<long> calls{0};

enum class Fate { kGo, kFail, kShort, kLost };

struct Plan {
  char kind[16] = "";
  long at = 0;
  const char* files = std::getenv("FRESHET_FAULT_FILES");
  Plan() {
    const char* text = std::getenv("FRESHET_FAULT");
    if (text != nullptr) std::sscanf(text, "%15[a-z]:%ld", kind, &at);
  }
  bool is(const char* name) const { return std::strcmp(kind, name) == 0; }
};

const Plan& plan() {
  static const Plan made;
  return made;
}

bool watched(const char* path) {
  return path != nullptr && plan().files != nullptr && std::strstr(path, plan().files) != nullptr;
}

bool watched(int fd) {
  char link[64], path[PATH_MAX];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length <= 0) return false;
  path[length] = 0;
  return watched(path);
}

// What becomes of a call on a watched file.
Fate fate(bool is_watched, bool writes) {
  if (!is_watched) return Fate::kGo;
  const long number = ++calls;
  const Plan& p = plan();
  if (p.is("full") ? number < p.at || p.at == 0 : number != p.at) return Fate::kGo;
  if (p.is("kill")) std::raise(SIGKILL);
  if (p.is("short")) return writes ? Fate::kShort : Fate::kGo;
  if (p.is("lost")) return writes ? Fate::kLost : Fate::kGo;
  errno = p.is("eio") ? EIO : p.is("eintr") ? EINTR : ENOSPC;
  return Fate::kFail;
}

template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

struct Report {
  ~Report() {
    const char* file = std::getenv("FRESHET_FAULT_COUNT");
    std::FILE* out = file != nullptr ? std::fopen(file, "w") : nullptr;
    if (out == nullptr) return;
    std::fprintf(out, "%ld\n", calls.load());
    std::fclose(out);
  }
} report;

}  // namespace

extern "C" {

ssize_t write(int fd, const void* from, size_t bytes) {
  static auto* const go = real<ssize_t(int, const void*, size_t)>("write");
  switch (fate(watched(fd), true)) {
    case Fate::kFail:
      return -1;
    case Fate::kShort:
      return go(fd, from, bytes / 2);
    case Fate::kLost:
      return static_cast<ssize_t>(bytes);
    default:
      return go(fd, from, bytes);
  }
}

ssize_t pwrite(int fd, const void* from, size_t bytes, off_t at) {
  static auto* const go = real<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  switch (fate(watched(fd), true)) {
    case Fate::kFail:
      return -1;
    case Fate::kShort:
      return go(fd, from, bytes / 2, at);
    case Fate::kLost:
      return static_cast<ssize_t>(bytes);
    default:
      return go(fd, from, bytes, at);
  }
}
ssize_t pwrite64(int fd, const void* from, size_t bytes, off_t at) { return pwrite(fd, from, bytes, at); }

ssize_t pwritev(int fd, const iovec* parts, int count, off_t at) {
  static auto* const go = real<ssize_t(int, const iovec*, int, off_t)>("pwritev");
  ssize_t all = 0;
  for (int i = 0; i < count; ++i) all += static_cast<ssize_t>(parts[i].iov_len);
  switch (fate(watched(fd), true)) {
    case Fate::kFail:
      return -1;
    case Fate::kShort:
      return go(fd, parts, (count + 1) / 2, at);
    case Fate::kLost:
      return all;
    default:
      return go(fd, parts, count, at);
  }
}
ssize_t pwritev64(int fd, const iovec* parts, int count, off_t at) { return pwritev(fd, parts, count, at); }

// What LMDB writes runs of pages with.
ssize_t writev(int fd, const iovec* parts, int count) {
  static auto* const go = real<ssize_t(int, const iovec*, int)>("writev");
  ssize_t all = 0;
  for (int i = 0; i < count; ++i) all += static_cast<ssize_t>(parts[i].iov_len);
  switch (fate(watched(fd), true)) {
    case Fate::kFail:
      return -1;
    case Fate::kShort:
      return go(fd, parts, (count + 1) / 2);
    case Fate::kLost:
      return all;
    default:
      return go(fd, parts, count);
  }
}

int fsync(int fd) {
  static auto* const go = real<int(int)>("fsync");
  return fate(watched(fd), false) == Fate::kFail ? -1 : go(fd);
}
int fdatasync(int fd) {
  static auto* const go = real<int(int)>("fdatasync");
  return fate(watched(fd), false) == Fate::kFail ? -1 : go(fd);
}
int ftruncate(int fd, off_t bytes) {
  static auto* const go = real<int(int, off_t)>("ftruncate");
  return fate(watched(fd), false) == Fate::kFail ? -1 : go(fd, bytes);
}
int ftruncate64(int fd, off_t bytes) { return ftruncate(fd, bytes); }

void* mmap(void* where, size_t bytes, int protection, int flags, int fd, off_t at) {
  static auto* const go = real<void*(void*, size_t, int, int, int, off_t)>("mmap");
  return fate(fd >= 0 && watched(fd), false) == Fate::kFail ? MAP_FAILED
                                                            : go(where, bytes, protection, flags, fd, at);
}
void* mmap64(void* where, size_t bytes, int protection, int flags, int fd, off_t at) {
  return mmap(where, bytes, protection, flags, fd, at);
}

int rename(const char* from, const char* to) {
  static auto* const go = real<int(const char*, const char*)>("rename");
  return fate(watched(from), false) == Fate::kFail ? -1 : go(from, to);
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  static auto* const go = real<int(int, const char*, int, const char*, unsigned)>("renameat2");
  return fate(watched(from), false) == Fate::kFail ? -1 : go(from_folder, from, to_folder, to, flags);
}

}  // extern "C"
