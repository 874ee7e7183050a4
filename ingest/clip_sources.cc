#include "ingest/clip_sources.h"

namespace freshet::ingest {
namespace {

/// Whether `name` is the clip's, its film's, or that of a folder that it lies in.
bool names(std::string name, const std::string& clip) {
  while (name.ends_with('/')) name.pop_back();
  return !name.empty() && clip.starts_with(name) &&
         (clip.size() == name.size() || clip[name.size()] == '/' || clip[name.size()] == '@');
}

}  // namespace

const ClipSource* source_of(const std::vector<ClipSource>& sources, const std::string& clip) {
  const ClipSource* found = nullptr;
  for (const ClipSource& each : sources)
    if (names(each.name, clip) && (found == nullptr || each.name.size() > found->name.size())) found = &each;
  return found;
}

}  // namespace freshet::ingest
