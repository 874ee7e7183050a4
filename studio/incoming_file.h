// studio/incoming_file.h — the place of a file that is being sent.
#pragma once

#include <filesystem>
#include <system_error>
#include <utility>

namespace freshet::studio {

/// A path where nothing lies yet; what was put there is removed at the end, unless it was moved away.
class IncomingFile {
 public:
  explicit IncomingFile(std::filesystem::path path) : path_(std::move(path)) {}
  IncomingFile(const IncomingFile&) = delete;
  IncomingFile& operator=(const IncomingFile&) = delete;
  ~IncomingFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace freshet::studio
