// tools/console/output_names.h — outputs whose names are wrong are refused before anything is computed.
#pragma once

#include <filesystem>

namespace freshet::tools {

/// Throws Error{kIo} when the folder does not exist. An empty path is an output that nobody asked for.
void check_output_folder(const std::filesystem::path& path);
/// Also throws Error{kUsage} when the ending names no picture format.
void check_picture_output(const std::filesystem::path& path);

}  // namespace freshet::tools
