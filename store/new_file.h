// store/new_file.h — a file that appears under its name whole, or not at all.
#pragma once

#include <filesystem>
#include <optional>

#include "platform/unfinished_files.h"

namespace freshet::store {

/// Renames where nothing of the name is there. False, with errno, when it cannot be done; EEXIST when there is
/// something already.
bool rename_to_new(const std::filesystem::path& from, const std::filesystem::path& to);

/// Makes a file's name durable: its folder is synced, where that can be done.
void sync_folder_of(const std::filesystem::path& file);

/// What a process that was killed while it made `file` has left beside it, and another may go on with.
std::filesystem::path unfinished_name(const std::filesystem::path& file);

enum class Existing { kKept, kReplaced };

/// Bytes are written beside the place that they are to take, synced, and given its name. Until then, and when the
/// process is killed at any instant, what was there is there still.
class NewFile {
 public:
  /// Throws Error{kIo} when it cannot be made, when another process is making it, or when there is a file of the
  /// name that is to be kept.
  NewFile(std::filesystem::path file, Existing existing);
  ~NewFile();  // removes what was not committed
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  int descriptor() const { return fd_; }
  /// With the mode of the file that it replaces. Throws Error{kIo}.
  void commit();

 private:
  [[noreturn]] void fail(const char* doing, int code) const;

  std::filesystem::path file_, unfinished_;
  std::optional<UnfinishedFile> listed_;  // once it is ours
  Existing existing_;
  int fd_ = -1;
};

}  // namespace freshet::store
