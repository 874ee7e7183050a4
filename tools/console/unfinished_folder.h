// tools/console/unfinished_folder.h — a folder of one's own for what is not done, which goes when its owner does.
#pragma once

#include <filesystem>

namespace freshet::tools {

class UnfinishedFolder {
 public:
  /// parent   made when it is not there. prefix   of a name that nothing else has.
  /// Throws   Error{kIo}.
  UnfinishedFolder(const std::filesystem::path& parent, const char* prefix);
  ~UnfinishedFolder();
  UnfinishedFolder(const UnfinishedFolder&) = delete;
  UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace freshet::tools
