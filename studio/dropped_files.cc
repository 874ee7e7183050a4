#include "studio/dropped_files.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "freshet/error.h"
#include "platform/text.h"
#include "platform/whole_file.h"
#include "studio/project.h"

namespace freshet::studio {

namespace fs = std::filesystem;

fs::path DroppedFiles::folder() const {
  const fs::path whole = project / within;
  for (fs::path path = whole; path != project; path = path.parent_path())
    if (fs::is_symlink(fs::symlink_status(path))) throw Error(ErrorKind::kIo, path.string(), "is no folder");
  return whole;
}

std::vector<std::string> DroppedFiles::names() const {
  std::vector<std::string> names;
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder(), fault))
    if (!entry.is_symlink() && entry.is_regular_file() && takes(entry.path().filename()))
      names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

std::string DroppedFiles::keep(const fs::path& file, const std::string& name) const {
  const fs::path whole = folder();
  std::error_code fault;
  fs::create_directories(whole, fault);
  const std::string stem = project_name(name), ending = lower_ending(name);
  fs::path path = whole / (stem + ending);
  for (int number = 2; fs::exists(fs::symlink_status(path)); ++number) {
    if (fs::is_regular_file(fs::symlink_status(path)) && same_bytes(path, file)) return path.filename();
    path = whole / fmt::format("{}-{}{}", stem, number, ending);
  }
  fs::rename(file, path, fault);
  if (fault) throw Error(ErrorKind::kIo, path.string(), "cannot be written");
  return path.filename();
}

}  // namespace freshet::studio
