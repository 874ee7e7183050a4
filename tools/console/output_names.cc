#include "tools/console/output_names.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"
#include "media/video/video_writer.h"
#include "tools/console/run_context.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

// Options that name files to be written. All others, and what stands without an option, may name inputs.
constexpr std::string_view kOutputs[] = {"--output",          "--sheet",      "--map",       "--alpha",
                                         "--emitters",        "--motion",     "--page",      "--json",
                                         "--composite",       "--draw",       "--matte-out", "--speed-out",
                                         "--orientation-out", "--motion-out", "--lines-out", "--layers-out",
                                         "--credits",         "--depth-out"};

bool names_output(const CLI::Option& option) {
  return std::ranges::find(kOutputs, option.get_name()) != std::end(kOutputs);
}

// Whether writing `output`, a file or a numbered sequence, would write over `input`.
bool writes_over(const fs::path& output, const fs::path& input) {
  std::error_code fault;
  // A folder is written into; its name may also be that of a preset scene.
  if (!media::is_pattern(output))
    return !fs::is_directory(output, fault) && fs::equivalent(output, input, fault);
  const fs::path folder = output.has_parent_path() ? output.parent_path() : ".";
  const auto is_frame = [&](const fs::path& file) {
    const std::string pattern = output.filename().string(), name = file.filename().string();
    const std::string before = pattern.substr(0, pattern.find('%')),
                      after = pattern.substr(std::min(pattern.find('d') + 1, pattern.size()));
    if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after))
      return false;
    const std::string number = name.substr(before.size(), name.size() - before.size() - after.size());
    return number.find_first_not_of("0123456789") == std::string::npos;
  };
  const bool pattern = media::is_pattern(input);
  if (!pattern && !fs::is_directory(input, fault)) {
    const fs::path beside = input.has_parent_path() ? input.parent_path() : ".";
    return is_frame(input) && fs::equivalent(folder, beside, fault);
  }
  const fs::path source = !pattern ? input : input.has_parent_path() ? input.parent_path() : ".";
  if (!fs::equivalent(folder, source, fault)) return false;
  return std::ranges::any_of(fs::directory_iterator(folder, fault), is_frame, &fs::directory_entry::path);
}

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

void refuse_overwriting(const CLI::App& app) {
  std::vector<std::string> inputs;
  std::vector<std::pair<std::string, std::string>> outputs;  // option, file
  for (const CLI::App* command = &app; command != nullptr;) {
    for (const CLI::Option* option : command->get_options())
      for (const std::string& value : option->results()) {
        if (value.empty()) continue;
        if (names_output(*option)) {
          outputs.emplace_back(option->get_name(), value);
          continue;
        }
        inputs.push_back(value);
        // PICTURE:MATTE
        if (const std::size_t colon = value.find(':'); colon != std::string::npos) {
          inputs.push_back(value.substr(0, colon));
          inputs.push_back(value.substr(colon + 1));
        }
      }
    const auto below = command->get_subcommands();
    command = below.empty() ? nullptr : below.front();
  }
  for (const auto& [option, output] : outputs)
    for (const std::string& input : inputs)
      if (writes_over(output, input)) {
        throw Error(ErrorKind::kUsage, option + " " + output,
                    "it would be written over " +
                        (input == output ? "an input of the same name" : "the input " + input),
                    "Choose another name");
      }
}

void add_overwrite(CLI::App& command) {
  command.add_flag_callback(
      "--overwrite", [] { overwrites = true; },
      "Replace existing outputs; without it the command refuses to start [off]");
}

void check_output_folder(const fs::path& path) {
  if (path.empty()) return;
  std::error_code fault;
  if (fs::is_directory(path, fault))
    throw Error(ErrorKind::kUsage, path.string(), "it is a folder", "Name a file in it");
  if (fs::exists(path, fault) && !fs::is_regular_file(path, fault))
    throw Error(ErrorKind::kUsage, path.string(), "it is a pipe or a device, which a file would replace",
                "Name a file");
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
                           : fmt::format("this and {} more frame{} exist, and are kept", taken - 1,
                                         taken == 2 ? "" : "s"),
                "Name another folder, or replace them with --overwrite");
  make_folder(folder_of(path), path);
}

void check_frames_output(const fs::path& path, int frames) {
  check_frames_output(path, {.first = 0, .last = frames - 1, .from = 0, .to = frames - 1});
}

void say_size(const fs::path& path, cv::Size size) {
  if (path.empty()) return;
  if (const std::string notice = media::size_notice(path, size); !notice.empty())
    say(path.string() + ": " + notice);
}

std::string frames_endings() {
  std::string films;
  for (const media::FileFormat& each : media::file_formats())
    if (each.kind == media::FormatKind::kFilm && each.coding != media::Coding::kNone && each.ending != ".png")
      films += fmt::format("{} ({}), ", each.ending, each.codec);
  return films + "or a sequence of " + media::written_endings([](const media::FileFormat& each) {
           return each.kind == media::FormatKind::kPicture;
         });
}

void check_folder_output(const fs::path& folder) {
  std::error_code fault;
  if (fs::is_directory(folder, fault) && !fs::is_empty(folder, fault) && !overwrites)
    throw Error(ErrorKind::kUsage, folder.string(), "something lies in this folder, and is kept",
                "Name a new folder, or replace what is there with --overwrite");
  make_folder(folder, folder);
}

}  // namespace freshet::tools
