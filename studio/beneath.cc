#include "studio/beneath.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int get() const { return number_; }
  int release() { return std::exchange(number_, -1); }

 private:
  int number_;
};

enum class Folders { kMustBeThere, kAreMade };

/// The folder that a file of a folder lies in; negative, with errno, where it is not there.
Descriptor parent_of(const fs::path& folder, const fs::path& within, Folders folders) {
  constexpr int kFlags = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
  Descriptor at(::open(folder.c_str(), kFlags));
  for (const fs::path& word : within.parent_path()) {
    if (at.get() < 0) return at;
    if (word == ".." || word.is_absolute()) {
      errno = EXDEV;
      return Descriptor(-1);
    }
    if (folders == Folders::kAreMade && ::mkdirat(at.get(), word.c_str(), 0777) != 0 && errno != EEXIST)
      return Descriptor(-1);
    at = Descriptor(::openat(at.get(), word.c_str(), kFlags));
  }
  return at;
}

[[noreturn]] void fail_writing(const fs::path& path, int fault) {
  const bool is_link = fault == ELOOP || fault == ENOTDIR || fault == EXDEV;
  throw Error(ErrorKind::kIo, path.string(),
              is_link ? "cannot be written: a symbolic link is on its way, or what is no folder"
                      : fmt::format("cannot be written ({})", std::strerror(fault)),
              is_link ? "Remove it" : "Free space on the disk");
}

}  // namespace

OpenFile::OpenFile(int descriptor, const fs::path& path) : descriptor_(descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor);
    throw Error(ErrorKind::kNotFound, path.filename().string(), "there is no such file");
  }
  bytes_ = static_cast<std::uint64_t>(status.st_size);
  changed_ns_ = std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec;
}

OpenFile::~OpenFile() { ::close(descriptor_); }

std::size_t OpenFile::read(char* into, std::size_t size, std::uint64_t from) const {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got = ::pread(descriptor_, into + done, size - done, static_cast<off_t>(from + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw Error(ErrorKind::kIo, "file", std::strerror(errno));
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

std::shared_ptr<const OpenFile> open_beneath(const fs::path& folder, const fs::path& within) {
  const Descriptor parent = parent_of(folder, within, Folders::kMustBeThere);
  // Without O_NONBLOCK a pipe that nobody writes to would be waited for.
  Descriptor file(parent.get() < 0 ? -1
                                   : ::openat(parent.get(), within.filename().c_str(),
                                              O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (file.get() < 0) throw Error(ErrorKind::kNotFound, within.filename().string(), "there is no such file");
  return std::make_shared<const OpenFile>(file.release(), within);
}

std::string read_beneath(const fs::path& folder, const fs::path& within, std::size_t max_bytes) {
  const std::shared_ptr<const OpenFile> file = open_beneath(folder, within);
  if (file->bytes() > max_bytes)
    throw Error(ErrorKind::kInput, within.string(),
                fmt::format("has {} bytes, at most {} expected", file->bytes(), max_bytes));
  std::string text(file->bytes(), '\0');
  text.resize(file->read(text.data(), text.size(), 0));
  return text;
}

void write_beneath(const fs::path& folder, const fs::path& within, std::string_view bytes) {
  const fs::path path = folder / within;
  const std::string name = within.filename(), beside = name + ".new";
  const Descriptor parent = parent_of(folder, within, Folders::kAreMade);
  if (parent.get() < 0) fail_writing(path, errno);
  Descriptor file(
      ::openat(parent.get(), beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644));
  if (file.get() < 0) fail_writing(path, errno);
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t put = ::write(file.get(), bytes.data() + done, bytes.size() - done);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) {
      const int fault = errno;
      ::unlinkat(parent.get(), beside.c_str(), 0);
      fail_writing(path, fault);
    }
    done += static_cast<std::size_t>(put);
  }
  if (::renameat(parent.get(), beside.c_str(), parent.get(), name.c_str()) != 0) fail_writing(path, errno);
}

void expect_no_links(const fs::path& folder) {
  std::error_code fault;
  for (fs::recursive_directory_iterator entry(folder, fault), end; !fault && entry != end;
       entry.increment(fault))
    if (entry->is_symlink())
      throw Error(ErrorKind::kInput, entry->path().string(), "a symbolic link lies in a project",
                  "Remove it, or put in its place what it names");
  if (fault) throw Error(ErrorKind::kIo, folder.string(), "cannot be listed (" + fault.message() + ")");
}

}  // namespace freshet::studio
