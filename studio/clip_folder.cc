#include "studio/clip_folder.h"

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "studio/drawing/flowlines.h"
#include "studio/dropped_files.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;

DroppedFiles clips_of(const fs::path& project) {
  return {.project = project,
          .within = fs::path(own_clip_path("x")).parent_path(),
          .wanted = media::looks_like_video};
}

}  // namespace

std::vector<std::string> clip_names(const fs::path& project) { return clips_of(project).names(); }

std::string add_clip(const fs::path& project, const fs::path& file, const std::string& name) {
  const DroppedFiles clips = clips_of(project);
  if (!clips.takes(name))
    throw Error(ErrorKind::kInput, name, "its ending names no video", "Give MP4, MOV, MKV, AVI or WebM");
  if (clips.names().size() >= kMostClips)
    throw Error(ErrorKind::kUsage, name, fmt::format("there are {} clips already", kMostClips),
                "Open another picture's project");
  return clips.keep(file, name);
}

}  // namespace freshet::studio
