#include "tools/console/output_names.h"

#include "freshet/error.h"
#include "media/picture/picture.h"

namespace freshet::tools {

void check_output_folder(const std::filesystem::path& path) {
  if (path.empty()) return;
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  std::error_code fault;
  if (!std::filesystem::is_directory(folder, fault))
    throw Error(ErrorKind::kIo, path.string(), "the folder " + folder.string() + " does not exist",
                "Make it first");
  if (std::filesystem::is_directory(path, fault))
    throw Error(ErrorKind::kUsage, path.string(), "it is a folder", "Name a file in it");
}

void check_picture_output(const std::filesystem::path& path) {
  if (path.empty()) return;
  check_output_folder(path);
  media::check_picture_name(path);
}

}  // namespace freshet::tools
