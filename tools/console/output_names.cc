#include "tools/console/output_names.h"

#include <string>
#include <vector>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

bool overwrites = false;  // of this run's command line

void make_folder(const fs::path& folder, const fs::path& path) {
  std::error_code fault;
  fs::create_directories(folder, fault);
  if (fault || !fs::is_directory(folder))
    throw Error(ErrorKind::kIo, path.string(),
                "the folder " + folder.string() + " cannot be made (" +
                    (fault ? fault.message() : "a file has its name") + ")",
                "Name another place");
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

}  // namespace

void add_overwrite(CLI::App& command) {
  command.add_flag_callback(
      "--overwrite", [] { overwrites = true; },
      "Replace outputs that exist; without it they are kept, and the command does not begin [off]");
}

void check_output_folder(const fs::path& path) {
  if (path.empty()) return;
  std::error_code fault;
  if (fs::is_directory(path, fault))
    throw Error(ErrorKind::kUsage, path.string(), "it is a folder", "Name a file in it");
  if (!overwrites && fs::is_regular_file(path, fault))
    throw Error(ErrorKind::kUsage, path.string(), "it exists, and is kept",
                "Name another file, or replace it with --overwrite");
  make_folder(folder_of(path), path);
}

void check_picture_output(const fs::path& path) {
  if (path.empty()) return;
  check_output_folder(path);
  media::check_picture_name(path);
}

void check_frames_output(const fs::path& path, const FrameNumbers& numbers) {
  if (path.empty() || !media::is_pattern(path)) return check_output_folder(path);
  const media::PictureSequence there = media::find_pattern(path);
  std::size_t taken = 0;
  fs::path first_taken;
  for (std::size_t i = 0; i < there.files.size(); ++i) {
    const std::int64_t number = there.numbers[i];
    if (number < numbers.first || number > numbers.last)
      throw Error(ErrorKind::kUsage, there.files[i].string(),
                  fmt::format("a frame of another run: it would stand among frames {} to {} of this one",
                              numbers.first, numbers.last),
                  "Name another folder, or move that sequence away");
    if (number < numbers.from || number > numbers.to) continue;
    if (taken++ == 0) first_taken = there.files[i];
  }
  if (taken > 0 && !overwrites)
    throw Error(ErrorKind::kUsage, first_taken.string(),
                taken == 1 ? std::string("this frame exists, and is kept")
                           : fmt::format("this and {} more frames exist, and are kept", taken - 1),
                "Name another folder, or replace them with --overwrite");
  make_folder(folder_of(path), path);
}

void check_frames_output(const fs::path& path, int frames) {
  check_frames_output(path, {.first = 0, .last = frames - 1, .from = 0, .to = frames - 1});
}

void check_folder_output(const fs::path& folder) {
  std::error_code fault;
  if (fs::is_directory(folder, fault) && !fs::is_empty(folder, fault) && !overwrites)
    throw Error(ErrorKind::kUsage, folder.string(), "something lies in this folder, and is kept",
                "Name a new folder, or replace what is there with --overwrite");
  make_folder(folder, folder);
}

}  // namespace freshet::tools
