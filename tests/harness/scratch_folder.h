// tests/harness/scratch_folder.h — a folder for what a test writes.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>

namespace freshet {

/// A folder that goes when the test does.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "freshet-test-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~ScratchFolder() { std::filesystem::remove_all(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace freshet
