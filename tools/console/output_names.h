// tools/console/output_names.h — outputs whose names are wrong are refused before anything is computed.
#pragma once

#include <filesystem>

#include <CLI/CLI.hpp>

namespace freshet::tools {

/// Throws Error{kIo} when the folder does not exist. An empty path is an output that nobody asked for.
void check_output_folder(const std::filesystem::path& path);
/// Also throws Error{kUsage} when the ending names no picture format.
void check_picture_output(const std::filesystem::path& path);

/// Throws Error{kUsage} when a file that the command line asks to write is one that it names otherwise: under
/// another name, by a link, or as a picture of a sequence. Call it when all has been parsed, before any command
/// runs.
void refuse_overwriting(const CLI::App& app);

}  // namespace freshet::tools
