// studio/beneath.h — files of a project's folder, reached by no link.
//
// A folder may come from somebody else, with links in it that lead to this user's own files. So every folder on the way
// to a file is opened by itself, from the one before, and none of them, nor the file, may be a symbolic link. (What
// openat2 does with RESOLVE_NO_SYMLINKS and RESOLVE_BENEATH; this makes folders on its way too, and needs no Linux
// 5.6.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace freshet::studio {

/// A regular file that is open for reading.
class OpenFile {
 public:
  /// Takes it over. Throws Error{kNotFound} for what is no regular file.
  OpenFile(int descriptor, const std::filesystem::path& path);
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile();

  std::uint64_t bytes() const { return bytes_; }
  std::int64_t changed_ns() const { return changed_ns_; }  // since 1970
  /// Fewer bytes than asked for at its end. Throws Error{kIo}. Safe from many threads.
  std::size_t read(char* into, std::size_t size, std::uint64_t from) const;

 private:
  int descriptor_;
  std::uint64_t bytes_ = 0;
  std::int64_t changed_ns_ = 0;
};

/// within   from the folder, without "..": "ways/design/film.mp4". Never null.
/// Throws Error{kNotFound} where it is not there, no regular file, or behind a link.
std::shared_ptr<const OpenFile> open_beneath(const std::filesystem::path& folder,
                                             const std::filesystem::path& within);
/// All of it. Throws as open_beneath, Error{kInput} above max_bytes.
std::string read_beneath(const std::filesystem::path& folder, const std::filesystem::path& within,
                         std::size_t max_bytes);
/// Beside its place, and renamed: who reads it finds the old or the new, whenever we are killed. Folders on its way are
/// made. Throws Error{kIo}, where a link is on its way too.
void write_beneath(const std::filesystem::path& folder, const std::filesystem::path& within,
                   std::string_view bytes);

/// For a command that opens the folder's files itself. Throws Error{kInput} naming the first symbolic link in it,
/// however deep.
void expect_no_links(const std::filesystem::path& folder);

}  // namespace freshet::studio
