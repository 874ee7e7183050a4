// studio/clip_folder.h — clips that were given to a project alone: files beside each other, own_clip_path().
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace freshet::studio {

/// In the order of their names; empty where there are none. project   its folder.
std::vector<std::string> clip_names(const std::filesystem::path& project);

/// file   moved; a clip of the same bytes and name is there once. name   as a person called it, of which a plain one is
///        made and returned.
/// Throws Error{kInput} for a name that is no video's; Error{kUsage} above kMostClips; Error{kIo}.
std::string add_clip(const std::filesystem::path& project, const std::filesystem::path& file,
                     const std::string& name);
inline constexpr std::size_t kMostClips = 20;

}  // namespace freshet::studio
