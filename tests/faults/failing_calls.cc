// A library to be preloaded: makes the n-th call that changes or reads a file fail, or end the process, or the n-th
// allocation. For tests only.
//
// FRESHET_FAULT=KIND:N   KIND is enospc, eio, eintr (the call does nothing and fails), full (enospc from the n-th
//                        on), short (a write takes half), lost (a write is said to have been done and is not) or
//                        kill (SIGKILL before the call).
//                        slow: every call takes some milliseconds. cut: the file loses its second half when it
//                        has been mapped, so that reading that is a bus error, as where a disk fails. alloc (the n-th
//                        allocation after main has begun fails), allocs (and all after it).
// FRESHET_FAULT_READS    Set: calls that read are meant, else those that change.
// FRESHET_FAULT_FILES    Only files whose path contains this.
// FRESHET_CLOCK_JUMPS    Set: the time of day is an hour earlier or later at every look, at random.
// FRESHET_FAULT_COUNT    A file to which the number of such calls, or of allocations, is written at the end.
//
// Calls that the C library makes inside itself (fwrite's own) do not come here.

#include <dlfcn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <new>

namespace {

std::atomic<long> calls{0};

enum class Fate { kGo, kFail, kShort, kLost, kCut };
enum class Call { kWrite, kChange, kRead };

struct Plan {
  char kind[16] = "";
  long at = 0;
  const char* files = std::getenv("FRESHET_FAULT_FILES");
  bool reads = std::getenv("FRESHET_FAULT_READS") != nullptr;
  bool clock_jumps = std::getenv("FRESHET_CLOCK_JUMPS") != nullptr;
  Plan() {
    const char* text = std::getenv("FRESHET_FAULT");
    if (text != nullptr) std::sscanf(text, "%15[a-z]:%ld", kind, &at);
  }
  bool is(const char* name) const { return std::strcmp(kind, name) == 0; }
};

// Made when it is first asked for, and anew where main begins: the environment may be another one then.
Plan& plan() {
  static Plan made;
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
Fate fate(bool is_watched, Call call) {
  const Plan& p = plan();
  if (!is_watched || (call == Call::kRead) != p.reads) return Fate::kGo;
  const long number = ++calls;
  if (p.is("slow")) {
    const timespec moment{0, 3'000'000};
    nanosleep(&moment, nullptr);
    return Fate::kGo;
  }
  if (p.is("full") ? number < p.at || p.at == 0 : number != p.at) return Fate::kGo;
  if (p.is("kill")) std::raise(SIGKILL);
  if (p.is("short")) return call != Call::kChange ? Fate::kShort : Fate::kGo;
  if (p.is("lost")) return call == Call::kWrite ? Fate::kLost : Fate::kGo;
  if (p.is("cut")) return Fate::kCut;
  if (p.is("alloc") || p.is("allocs")) return Fate::kGo;
  errno = p.is("eio") ? EIO : p.is("eintr") ? EINTR : ENOSPC;
  return Fate::kFail;
}

// Allocations are counted while main runs: before it and after it, most are the loader's and of libraries' globals.
std::atomic<bool> counting{false};
std::atomic<long> allocations{0};

bool allocation_fails() {
  if (!counting.load(std::memory_order_relaxed)) return false;
  static const bool once = plan().is("alloc"), on = plan().is("allocs");  // asked first in main
  static const long at = plan().at;
  const long number = ++allocations;
  if (at == 0 || !(once ? number == at : on && number >= at)) return false;
  errno = ENOMEM;
  return true;
}

template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

struct Report {
  ~Report() {
    counting = false;
    const char* file = std::getenv("FRESHET_FAULT_COUNT");
    std::FILE* out = file != nullptr ? std::fopen(file, "w") : nullptr;
    if (out == nullptr) return;
    std::fprintf(out, "%ld\n", plan().is("alloc") || plan().is("allocs") ? allocations.load() : calls.load());
    std::fclose(out);
  }
} report;

}  // namespace

extern "C" {

ssize_t write(int fd, const void* from, size_t bytes) {
  static auto* const go = real<ssize_t(int, const void*, size_t)>("write");
  switch (fate(watched(fd), Call::kWrite)) {
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
  switch (fate(watched(fd), Call::kWrite)) {
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
  switch (fate(watched(fd), Call::kWrite)) {
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
  switch (fate(watched(fd), Call::kWrite)) {
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
  return fate(watched(fd), Call::kChange) == Fate::kFail ? -1 : go(fd);
}
int fdatasync(int fd) {
  static auto* const go = real<int(int)>("fdatasync");
  return fate(watched(fd), Call::kChange) == Fate::kFail ? -1 : go(fd);
}
int ftruncate(int fd, off_t bytes) {
  static auto* const go = real<int(int, off_t)>("ftruncate");
  return fate(watched(fd), Call::kChange) == Fate::kFail ? -1 : go(fd, bytes);
}
int ftruncate64(int fd, off_t bytes) { return ftruncate(fd, bytes); }

void* mmap(void* where, size_t bytes, int protection, int flags, int fd, off_t at) {
  static auto* const go = real<void*(void*, size_t, int, int, int, off_t)>("mmap");
  const Fate becomes = fate(fd >= 0 && watched(fd), Call::kChange);
  if (becomes == Fate::kFail) return MAP_FAILED;
  void* const mapped = go(where, bytes, protection, flags, fd, at);
  struct stat status {};
  if (becomes == Fate::kCut && fstat(fd, &status) == 0) {
    char link[64];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    if (truncate(link, status.st_size / 2) != 0) std::abort();
  }
  return mapped;
}
void* mmap64(void* where, size_t bytes, int protection, int flags, int fd, off_t at) {
  return mmap(where, bytes, protection, flags, fd, at);
}

int rename(const char* from, const char* to) {
  static auto* const go = real<int(const char*, const char*)>("rename");
  return fate(watched(from), Call::kChange) == Fate::kFail ? -1 : go(from, to);
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  static auto* const go = real<int(int, const char*, int, const char*, unsigned)>("renameat2");
  return fate(watched(from), Call::kChange) == Fate::kFail ? -1 : go(from_folder, from, to_folder, to, flags);
}

ssize_t read(int fd, void* into, size_t bytes) {
  static auto* const go = real<ssize_t(int, void*, size_t)>("read");
  const Fate becomes = fate(watched(fd), Call::kRead);
  return becomes == Fate::kFail ? -1 : go(fd, into, becomes == Fate::kShort ? (bytes + 1) / 2 : bytes);
}
ssize_t pread(int fd, void* into, size_t bytes, off_t at) {
  static auto* const go = real<ssize_t(int, void*, size_t, off_t)>("pread");
  const Fate becomes = fate(watched(fd), Call::kRead);
  return becomes == Fate::kFail ? -1 : go(fd, into, becomes == Fate::kShort ? (bytes + 1) / 2 : bytes, at);
}
ssize_t pread64(int fd, void* into, size_t bytes, off_t at) { return pread(fd, into, bytes, at); }

int clock_gettime(clockid_t clock, timespec* now) {
  static auto* const go = real<int(clockid_t, timespec*)>("clock_gettime");
  static std::atomic<unsigned> looks{1};
  const int code = go(clock, now);
  if (plan().clock_jumps && code == 0 && clock == CLOCK_REALTIME)
    now->tv_sec += static_cast<int>(++looks * 2654435761u >> 8) % 7200 - 3600;
  return code;
}
int gettimeofday(timeval* now, void*) {
  timespec precise{};
  clock_gettime(CLOCK_REALTIME, &precise);
  *now = {precise.tv_sec, precise.tv_nsec / 1000};
  return 0;
}
time_t time(time_t* now) {
  timespec precise{};
  clock_gettime(CLOCK_REALTIME, &precise);
  if (now != nullptr) *now = precise.tv_sec;
  return precise.tv_sec;
}

#ifdef FRESHET_ADDRESS_SANITIZER  // whose memory all of it must be
#define ALLOCATOR(name) __interceptor_##name
#else  // the C library's own, under the names that it keeps for this
#define ALLOCATOR(name) __libc_##name
#endif
void* ALLOCATOR(malloc)(size_t);
void* ALLOCATOR(calloc)(size_t, size_t);
void* ALLOCATOR(realloc)(void*, size_t);
void* ALLOCATOR(memalign)(size_t, size_t);

void* malloc(size_t bytes) { return allocation_fails() ? nullptr : ALLOCATOR(malloc)(bytes); }
void* calloc(size_t count, size_t bytes) {
  return allocation_fails() ? nullptr : ALLOCATOR(calloc)(count, bytes);
}
void* realloc(void* at, size_t bytes) { return allocation_fails() ? nullptr : ALLOCATOR(realloc)(at, bytes); }
void* memalign(size_t alignment, size_t bytes) {
  return allocation_fails() ? nullptr : ALLOCATOR(memalign)(alignment, bytes);
}
void* aligned_alloc(size_t alignment, size_t bytes) { return memalign(alignment, bytes); }
int posix_memalign(void** at, size_t alignment, size_t bytes) {
  if (allocation_fails()) return ENOMEM;
  *at = ALLOCATOR(memalign)(alignment, bytes);
  return *at == nullptr ? ENOMEM : 0;
}

namespace {
int (*true_main)(int, char**, char**);
int counted_main(int count, char** arguments, char** environment) {
  plan() = Plan();
  calls = 0;
  counting = true;
  const int code = true_main(count, arguments, environment);
  counting = false;
  return code;
}
}  // namespace

int __libc_start_main(int (*main)(int, char**, char**), int count, char** arguments, void (*init)(),
                      void (*fini)(), void (*loader_fini)(), void* stack_end) {
  using Start = int(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(), void*);
  true_main = main;
  return real<Start>("__libc_start_main")(counted_main, count, arguments, init, fini, loader_fini, stack_end);
}

}  // extern "C"

#ifdef FRESHET_ADDRESS_SANITIZER  // whose operators ask no malloc
void* operator new(size_t bytes) {
  static auto* const go = real<void*(size_t)>("_Znwm");
  if (allocation_fails()) throw std::bad_alloc();
  return go(bytes);
}
void* operator new[](size_t bytes) {
  static auto* const go = real<void*(size_t)>("_Znam");
  if (allocation_fails()) throw std::bad_alloc();
  return go(bytes);
}
#endif
