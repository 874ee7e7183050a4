#include "studio/still_folder.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "platform/text.h"
#include "platform/whole_file.h"
#include "studio/project.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;

constexpr int kThumbnailSide = 160;  // px

/// Throws Error{kIo} where a link leads out of the project.
fs::path pictures_of(const fs::path& project) {
  const fs::path folder = project / "ways" / "stills" / "pictures";
  for (const fs::path& path : {project / "ways", project / "ways" / "stills", folder})
    if (fs::is_symlink(fs::symlink_status(path))) throw Error(ErrorKind::kIo, path.string(), "is no folder");
  return folder;
}

bool is_still(const std::string& ending) {
  static const std::vector<std::string> kEndings{".png", ".jpg", ".jpeg", ".tif", ".tiff"};
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

}  // namespace

std::vector<std::string> still_names(const fs::path& project) {
  std::vector<std::string> names;
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(pictures_of(project), fault))
    if (!entry.is_symlink() && entry.is_regular_file() && is_still(entry.path().extension()))
      names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

void add_still(const fs::path& project, const fs::path& file, const std::string& name) {
  const std::string ending = lower_ending(name);
  if (!is_still(ending))
    throw Error(ErrorKind::kInput, name, "it is no still that can be opened", "Give a PNG, JPEG or TIFF");
  if (still_names(project).size() >= kMostStills)
    throw Error(ErrorKind::kUsage, name, fmt::format("there are {} stills already", kMostStills),
                "Ten to twenty are enough");
  const fs::path folder = pictures_of(project);
  std::error_code fault;
  fs::create_directories(folder, fault);
  fs::path path = folder / (project_name(name) + ending);
  for (int number = 2; fs::exists(fs::symlink_status(path)); ++number) {
    if (fs::is_regular_file(fs::symlink_status(path)) && same_bytes(path, file)) return;
    path = folder / fmt::format("{}-{}{}", project_name(name), number, ending);
  }
  fs::rename(file, path, fault);
  if (fault) throw Error(ErrorKind::kIo, path.string(), "cannot be written");
}

void remove_stills(const fs::path& project) {
  std::error_code fault;
  fs::remove_all(pictures_of(project).parent_path(), fault);
  if (fault) throw Error(ErrorKind::kIo, project.filename().string(), "its stills cannot be removed");
}

std::string still_thumbnail(const fs::path& project, const std::string& name) {
  const std::vector<std::string> names = still_names(project);
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw Error(ErrorKind::kNotFound, name, "there is no such still");
  return small_jpeg(media::read_still(pictures_of(project) / name).bgr, kThumbnailSide);
}

}  // namespace freshet::studio
