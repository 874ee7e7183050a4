#include "synth/transfer/files/resume_folder.h"

#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/picture/picture_sequence.h"

namespace freshet::synth::transfer {
namespace {

namespace fs = std::filesystem;

void write_whole(const fs::path& path, const std::string& text) {
  const fs::path draft = path.string() + ".part";
  std::ofstream file(draft, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  std::error_code fault;
  if (file) fs::rename(draft, path, fault);
  if (!file || fault)
    throw Error(ErrorKind::kIo, path.string(), "it cannot be written", "Make room on the disk");
}

nlohmann::json read_json(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return nlohmann::json::parse(file, nullptr, false);
}

}  // namespace

fs::path ResumeFolder::beside(const fs::path& output) {
  if (!media::is_pattern(output)) return output.string() + ".resume";
  const std::string name = output.stem().string();
  const std::string before = name.substr(0, name.find_first_of("%#"));
  return output.parent_path() / (before.empty() ? "frames.resume" : before + "frames.resume");
}

ResumeFolder::ResumeFolder(const fs::path& folder, const nlohmann::json& job, bool restart)
    : folder_(folder) {
  std::error_code fault;
  if (restart) fs::remove_all(folder_, fault);
  const fs::path of_job = folder_ / "job.json";
  if (fs::exists(of_job)) {
    const nlohmann::json there = read_json(of_job);
    if (there == job) return;
    std::string key = "something";
    if (there.is_object())
      for (const auto& [name, value] : job.items())
        if (key == "something" && there.value(name, nlohmann::json()) != value)
          key = fmt::format("{} (then {}, now {})", name, there.value(name, nlohmann::json()).dump(),
                            value.dump());
    throw Error(ErrorKind::kUsage, folder_.string(), "an unfinished run is kept here that differs in " + key,
                "Give the same as then to go on, --restart to begin anew, or another output");
  }
  fs::create_directories(folder_, fault);
  if (fault || !fs::is_directory(folder_))
    throw Error(
        ErrorKind::kIo, folder_.string(),
        "no folder can be made here to keep an unfinished run in" + (fault ? ": " + fault.message() : ""),
        "Choose another place for the output");
  write_whole(of_job, job.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

nlohmann::json ResumeFolder::resume(Transfer& transfer) const {
  if (!fs::exists(folder_ / "state")) return nlohmann::json::array();
  transfer.load_state(folder_ / "state");
  nlohmann::json notes = read_json(folder_ / "frames.json");
  const auto frames = static_cast<std::size_t>(transfer.frame());
  // Notes are written before the state, and so may be one ahead.
  if (!notes.is_array() || notes.size() < frames)
    throw Error(ErrorKind::kInput, (folder_ / "frames.json").string(), "it does not fit the state beside it",
                "Begin anew with --restart");
  notes.erase(notes.begin() + static_cast<std::ptrdiff_t>(frames), notes.end());
  return notes;
}

void ResumeFolder::keep(const Transfer& transfer, const nlohmann::json& notes) const {
  write_whole(folder_ / "frames.json", notes.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  transfer.save_state(folder_ / "state.part");
  std::error_code fault;
  fs::rename(folder_ / "state.part", folder_ / "state", fault);
  if (fault)
    throw Error(ErrorKind::kIo, (folder_ / "state").string(), "it cannot be written: " + fault.message(),
                "Check the folder and its permissions");
}

void ResumeFolder::remove() const {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

}  // namespace freshet::synth::transfer
