#include "studio/clip_folder.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "freshet/error.h"
#include "platform/text.h"
#include "platform/whole_file.h"
#include "studio/drawing/endless.h"
#include "studio/project.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;

/// Throws Error{kIo} where a link leads out of the project.
fs::path clips_of(const fs::path& project) {
  const fs::path folder = (project / own_clip_path("x")).parent_path();
  for (fs::path path = folder; path != project; path = path.parent_path())
    if (fs::is_symlink(fs::symlink_status(path))) throw Error(ErrorKind::kIo, path.string(), "is no folder");
  return folder;
}

}  // namespace

bool is_video(const std::string& name) {
  static const std::vector<std::string> kEndings{".mp4", ".mov", ".mkv",  ".avi", ".webm",
                                                 ".m4v", ".mpg", ".mpeg", ".mxf"};
  return std::find(kEndings.begin(), kEndings.end(), lower_ending(name)) != kEndings.end();
}

std::vector<std::string> clip_names(const fs::path& project) {
  std::vector<std::string> names;
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(clips_of(project), fault))
    if (!entry.is_symlink() && entry.is_regular_file() && is_video(entry.path().filename()))
      names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

std::string add_clip(const fs::path& project, const fs::path& file, const std::string& name) {
  if (!is_video(name))
    throw Error(ErrorKind::kInput, name, "its ending names no video", "Give MP4, MOV, MKV, AVI or WebM");
  if (clip_names(project).size() >= kMostClips)
    throw Error(ErrorKind::kUsage, name, fmt::format("there are {} clips already", kMostClips),
                "Open another picture's project");
  const fs::path folder = clips_of(project);
  std::error_code fault;
  fs::create_directories(folder, fault);
  const std::string stem = project_name(name), ending = lower_ending(name);
  fs::path path = folder / (stem + ending);
  for (int number = 2; fs::exists(fs::symlink_status(path)); ++number) {
    if (fs::is_regular_file(fs::symlink_status(path)) && same_bytes(path, file)) return path.filename();
    path = folder / fmt::format("{}-{}{}", stem, number, ending);
  }
  fs::rename(file, path, fault);
  if (fault) throw Error(ErrorKind::kIo, path.string(), "cannot be written");
  return path.filename();
}

}  // namespace freshet::studio
