// tools/console/output_names.h — outputs whose names are wrong or taken are refused before anything is computed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

namespace freshet::tools {

/// The option --overwrite, of commands that write files. Until it is given, the functions below refuse names that
/// are taken. Applied when the option is parsed.
void add_overwrite(CLI::App& command);

/// A file that will be written: its folder is made when it is not there. An empty path is an output that nobody
/// asked for. Throws Error{kUsage} when the path is a folder, or a file that --overwrite does not give up;
/// Error{kIo} when the folder cannot be made.
void check_output_folder(const std::filesystem::path& path);
/// Also throws Error{kUsage} when the ending names no picture format.
void check_picture_output(const std::filesystem::path& path);

/// The numbers of an animation's frames, and of those among them that this run writes.
struct FrameNumbers {
  std::int64_t first = 0, last = 0;
  std::int64_t from = 0, to = 0;
};
/// An animation: a file as above, or a numbered sequence, among whose frames none of another run may stand.
/// Throws Error{kUsage} when one that would be written is there and --overwrite was not given, and, whatever was
/// given, when one outside first..last is: it would follow ours, or go before them.
void check_frames_output(const std::filesystem::path& path, const FrameNumbers& numbers);
/// Frames numbered from 0, all of them.
void check_frames_output(const std::filesystem::path& path, int frames);

/// Says what the format makes of frames of this size, where that is worth a word: an .mp4 of odd sides is larger.
void say_size(const std::filesystem::path& path, cv::Size size);
/// What an animation can be written as, for --help: ".mp4 (H.264), ..., or a sequence of .png, .exr or .tif".
std::string frames_endings();

/// A folder that a command fills; made when it is not there. Throws Error{kUsage} when something lies in it and
/// --overwrite was not given; Error{kIo} when it cannot be made.
void check_folder_output(const std::filesystem::path& folder);

/// Throws Error{kUsage} when a file that the command line asks to write is one that it names otherwise: under
/// another name, by a link, or as a picture of a sequence. Call it when all has been parsed, before any command
/// runs.
void refuse_overwriting(const CLI::App& app);

}  // namespace freshet::tools
