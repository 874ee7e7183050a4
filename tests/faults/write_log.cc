// A library to be preloaded: writes down every change of a file, for a test that replays it with power failing between.
//
// FRESHET_WRITE_LOG        the log
// FRESHET_WRITE_LOG_FILES  only files whose path contains this; syncs of folders are written down always
//
// An entry: u8 kind (tests/faults/write_log.h), u8 1 when the write is durable by itself (O_DSYNC), u32 length of the
// path, the path, u64 offset (of a truncation the size), u64 bytes, the bytes (of a renaming the new path).

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/uio.h>
#include <unistd.h>

#include <climits>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string>

#include "tests/faults/write_log.h"

namespace {

using freshet::tools::LogKind;

template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

std::string path_of(int fd) {
  char link[64], path[PATH_MAX];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t length = readlink(link, path, sizeof path);
  return length > 0 ? std::string(path, static_cast<std::size_t>(length)) : std::string();
}

bool watched(const std::string& path) {
  static const char* const files = std::getenv("FRESHET_WRITE_LOG_FILES");
  return files != nullptr && path.find(files) != std::string::npos;
}

void log(LogKind kind, bool durable, const std::string& path, std::uint64_t offset, const void* bytes,
         std::uint64_t size) {
  static std::mutex mutex;
  static const char* const name = std::getenv("FRESHET_WRITE_LOG");
  static const int to = name != nullptr ? ::open(name, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666) : -1;
  if (to < 0) return;
  const int kept = errno;
  std::string entry;
  const auto add = [&](const void* from, std::size_t count) {
    entry.append(static_cast<const char*>(from), count);
  };
  const auto length = static_cast<std::uint32_t>(path.size());
  entry += static_cast<char>(kind);
  entry += static_cast<char>(durable);
  add(&length, sizeof length);
  entry += path;
  add(&offset, sizeof offset);
  add(&size, sizeof size);
  add(bytes, size);
  static auto* const go = real<ssize_t(int, const void*, size_t)>("write");
  const std::lock_guard lock(mutex);
  if (go(to, entry.data(), entry.size()) != static_cast<ssize_t>(entry.size())) std::abort();
  errno = kept;
}

void log_write(int fd, std::uint64_t offset, const void* bytes, ssize_t wrote) {
  if (wrote <= 0) return;
  const std::string path = path_of(fd);
  if (watched(path))
    log(LogKind::kWrite, (fcntl(fd, F_GETFL) & O_DSYNC) != 0, path, offset, bytes,
        static_cast<std::uint64_t>(wrote));
}

std::string absolute(const char* path) {
  if (path[0] == '/') return path;
  char folder[PATH_MAX];
  return getcwd(folder, sizeof folder) != nullptr ? std::string(folder) + "/" + path : path;
}

void log_rename(const char* from, const char* to, int result) {
  const std::string source = absolute(from), target = absolute(to);
  if (result == 0 && watched(source)) log(LogKind::kRename, false, source, 0, target.data(), target.size());
}

void log_sync(int fd, int result) {
  if (result == 0) log(LogKind::kSync, true, path_of(fd), 0, nullptr, 0);
}

}  // namespace

extern "C" {

ssize_t write(int fd, const void* from, size_t bytes) {
  static auto* const go = real<ssize_t(int, const void*, size_t)>("write");
  const off_t at = lseek(fd, 0, SEEK_CUR);
  const ssize_t wrote = go(fd, from, bytes);
  if (at >= 0) log_write(fd, static_cast<std::uint64_t>(at), from, wrote);
  return wrote;
}

ssize_t pwrite(int fd, const void* from, size_t bytes, off_t at) {
  static auto* const go = real<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  const ssize_t wrote = go(fd, from, bytes, at);
  log_write(fd, static_cast<std::uint64_t>(at), from, wrote);
  return wrote;
}
ssize_t pwrite64(int fd, const void* from, size_t bytes, off_t at) { return pwrite(fd, from, bytes, at); }

ssize_t pwritev(int fd, const iovec* parts, int count, off_t at) {
  static auto* const go = real<ssize_t(int, const iovec*, int, off_t)>("pwritev");
  const ssize_t wrote = go(fd, parts, count, at);
  std::string bytes;
  for (int i = 0; i < count; ++i) bytes.append(static_cast<const char*>(parts[i].iov_base), parts[i].iov_len);
  log_write(fd, static_cast<std::uint64_t>(at), bytes.data(), wrote);
  return wrote;
}
ssize_t pwritev64(int fd, const iovec* parts, int count, off_t at) { return pwritev(fd, parts, count, at); }

// What LMDB writes runs of pages with.
ssize_t writev(int fd, const iovec* parts, int count) {
  static auto* const go = real<ssize_t(int, const iovec*, int)>("writev");
  const off_t at = lseek(fd, 0, SEEK_CUR);
  const ssize_t wrote = go(fd, parts, count);
  std::string bytes;
  for (int i = 0; i < count; ++i) bytes.append(static_cast<const char*>(parts[i].iov_base), parts[i].iov_len);
  if (at >= 0) log_write(fd, static_cast<std::uint64_t>(at), bytes.data(), wrote);
  return wrote;
}

int fsync(int fd) {
  static auto* const go = real<int(int)>("fsync");
  const int result = go(fd);
  log_sync(fd, result);
  return result;
}
int fdatasync(int fd) {
  static auto* const go = real<int(int)>("fdatasync");
  const int result = go(fd);
  log_sync(fd, result);
  return result;
}
int ftruncate(int fd, off_t bytes) {
  static auto* const go = real<int(int, off_t)>("ftruncate");
  const int result = go(fd, bytes);
  const std::string path = path_of(fd);
  if (result == 0 && watched(path))
    log(LogKind::kTruncate, false, path, static_cast<std::uint64_t>(bytes), nullptr, 0);
  return result;
}
int ftruncate64(int fd, off_t bytes) { return ftruncate(fd, bytes); }

int rename(const char* from, const char* to) {
  static auto* const go = real<int(const char*, const char*)>("rename");
  const int result = go(from, to);
  log_rename(from, to, result);
  return result;
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  static auto* const go = real<int(int, const char*, int, const char*, unsigned)>("renameat2");
  const int result = go(from_folder, from, to_folder, to, flags);
  log_rename(from, to, result);
  return result;
}

}  // extern "C"
