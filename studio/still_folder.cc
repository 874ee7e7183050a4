#include "studio/still_folder.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "media/picture/picture.h"
#include "studio/clip_strip.h"
#include "studio/dropped_files.h"
#include "studio/project.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;

constexpr int kThumbnailSide = 160;  // px

DroppedFiles stills_of(const fs::path& project) {
  return {.project = project, .within = "ways/stills/pictures", .wanted = media::looks_like_picture};
}

cv::Mat still_named(const fs::path& project, const std::string& name) {
  const DroppedFiles stills = stills_of(project);
  const std::vector<std::string> names = stills.names();
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw Error(ErrorKind::kNotFound, name, "there is no such still");
  return media::read_still(stills.folder() / name).bgr;
}

}  // namespace

std::vector<std::string> still_names(const fs::path& project) { return stills_of(project).names(); }

void add_still(const fs::path& project, const fs::path& file, const std::string& name) {
  const DroppedFiles stills = stills_of(project);
  if (!stills.takes(name))
    throw Error(ErrorKind::kInput, name, "it is no still that can be opened", "Give a PNG, JPEG or TIFF");
  if (stills.names().size() >= kMostStills)
    throw Error(ErrorKind::kUsage, name, fmt::format("there are {} stills already", kMostStills),
                "Ten to twenty are enough");
  stills.keep(file, name);
}

void remove_stills(const fs::path& project) {
  std::error_code fault;
  fs::remove_all(stills_of(project).folder().parent_path(), fault);
  if (fault) throw Error(ErrorKind::kIo, project.filename().string(), "its stills cannot be removed");
}

std::string still_jpeg(const fs::path& project, const std::string& name) {
  return encoded(still_named(project, name));
}

std::string still_thumbnail(const fs::path& project, const std::string& name) {
  return small_jpeg(still_named(project, name), kThumbnailSide);
}

}  // namespace freshet::studio
