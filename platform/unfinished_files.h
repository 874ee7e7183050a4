// platform/unfinished_files.h — files that a process which is ended in the midst of its work leaves behind unless it is
// told.
#pragma once

#include <filesystem>
#include <mutex>
#include <set>
#include <utility>

namespace freshet {

/// A file under a temporary name, as long as this lives. Its owner removes it, or gives it its name; where a process is
/// ended without its destructors, remove_unfinished_files() comes first.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(std::filesystem::path path) : path_(std::move(path)) {
    const std::lock_guard lock(mutex());
    paths().insert(path_);
  }
  ~UnfinishedFile() {
    const std::lock_guard lock(mutex());
    paths().erase(paths().find(path_));
  }
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

 private:
  friend void remove_unfinished_files();
  static std::mutex& mutex() {
    static std::mutex& one = *new std::mutex;  // outlives whoever is still at work at the end
    return one;
  }
  static std::multiset<std::filesystem::path>& paths() {
    static auto& all = *new std::multiset<std::filesystem::path>;
    return all;
  }

  std::filesystem::path path_;
};

/// Removes all that there are, and lets no more begin or end: the process is to be ended now.
inline void remove_unfinished_files() {
  UnfinishedFile::mutex().lock();
  std::error_code ignored;
  for (const std::filesystem::path& path : UnfinishedFile::paths()) std::filesystem::remove(path, ignored);
}

}  // namespace freshet
