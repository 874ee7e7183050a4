// studio/still_folder.h — the stills of a project's scene: files in PROJECT/ways/stills/pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace freshet::studio {

/// In the order of their names; empty where there are none. project   its folder.
std::vector<std::string> still_names(const std::filesystem::path& project);

/// file   moved; a still of the same bytes and name is there once. name   as a person called it, of which a plain one
///        is made.
/// Throws Error{kInput} for a name that is no PNG's, JPEG's or TIFF's; Error{kUsage} above kMostStills; Error{kIo}.
void add_still(const std::filesystem::path& project, const std::filesystem::path& file,
               const std::string& name);
inline constexpr std::size_t kMostStills = 60;

/// All of them, and what was made of them.
void remove_stills(const std::filesystem::path& project);

/// Upright, as JPEG, and a small one of it. Throws Error{kNotFound}, and as media::read_still.
std::string still_jpeg(const std::filesystem::path& project, const std::string& name);
std::string still_thumbnail(const std::filesystem::path& project, const std::string& name);

}  // namespace freshet::studio
