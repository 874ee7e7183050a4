#include "studio/stores.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "platform/whole_file.h"
#include "store/store_list.h"
#include "studio/clip_strip.h"
#include "work/command_run.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A name for a folder or file that says what a person called it, and nothing more.
std::string tame(const std::string& name, std::size_t most) {
  std::string tamed;
  for (const char c : name) {
    const auto letter = static_cast<unsigned char>(c);
    tamed += letter < 128 && (std::isalnum(letter) != 0 || c == '.' || c == '-' || c == '_') ? c : '_';
  }
  tamed = tamed.substr(0, most);
  if (tamed.empty() || tamed.front() == '.' || tamed.front() == '-') tamed = "_" + tamed;
  return tamed;
}

/// Whether ingest went through all clips and took none: the reasons are an answer too, though it ends with 1.
bool only_refused(const Json& report) {
  if (!report.is_object() || !report.contains("clips") || report["clips"].empty() ||
      report.contains("stopped"))
    return false;
  return std::none_of(report["clips"].begin(), report["clips"].end(), [](const Json& clip) {
    const std::string outcome = clip.value("outcome", "");
    return outcome != "refused" && outcome != "failed";
  });
}

}  // namespace

Stores::Stores(StudioFolder& folder, Jobs& jobs, std::vector<fs::path> given, fs::path program)
    : folder_(folder), jobs_(jobs), given_(std::move(given)), program_(std::move(program)) {
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_.stores(), fault))
    if (entry.path().extension() == ".freshet" && entry.is_regular_file()) add(entry.path());
  for (const fs::path& path : given_) add(path);
}

std::vector<std::shared_ptr<OpenedStore>> Stores::all() const {
  const std::lock_guard lock(guard_);
  std::vector<std::shared_ptr<OpenedStore>> all;
  for (const auto& [id, store] : stores_) all.push_back(store);
  return all;
}

void Stores::add(const fs::path& path) {
  auto store = std::make_shared<OpenedStore>(fs::weakly_canonical(path));
  if (store->exists()) store->snapshot();  // what is wrong with it is said when it is opened
  stores_.emplace(store->id(), store);
}

std::shared_ptr<OpenedStore> Stores::get(const std::string& id) const {
  const std::lock_guard lock(guard_);
  const auto found = stores_.find(id);
  if (found == stores_.end()) throw Error(ErrorKind::kNotFound, "store", "there is no such store");
  return found->second;
}

std::shared_ptr<OpenedStore> Stores::at(const std::string& path) const {
  const std::lock_guard lock(guard_);
  for (const auto& [id, store] : stores_)
    if (store->path() == path) return store;
  return nullptr;
}

std::string Stores::likely() const {
  const std::lock_guard lock(guard_);
  if (!given_.empty()) return fs::weakly_canonical(given_.front());
  std::string likely;
  std::size_t most = 0;
  for (const auto& [id, store] : stores_) {
    const std::size_t clips = store->exists() ? store->snapshot().clips().size() : 0;
    if (clips <= most) continue;
    most = clips;
    likely = store->path();
  }
  return likely;
}

std::string Stores::take(const fs::path& file, const std::string& name) {
  std::error_code fault;
  try {
    store::Store::open_read(file).snapshot();
  } catch (const Error&) {
    fs::remove(file.string() + "-lock", fault);
    throw Error(
        ErrorKind::kInput, name, "it is no store that can be opened",
        "Give a file that freshet ingest made; freshet store verify says what is wrong with a damaged one");
  }
  fs::remove(file.string() + "-lock", fault);
  const std::string stem = tame(fs::path(name).stem(), 60);
  for (int number = 1; number < 1000; ++number) {
    const fs::path path =
        folder_.stores() / (number == 1 ? stem + ".freshet" : fmt::format("{}-{}.freshet", stem, number));
    // A link, not a rename: of two that come at once, one finds the other's.
    if (::link(file.c_str(), path.c_str()) != 0) {
      const bool is_there = errno == EEXIST;
      if (is_there && (fs::is_symlink(fs::symlink_status(path)) || !same_bytes(path, file))) continue;
      if (!is_there) fs::rename(file, path);  // a file system without links
    }
    const std::lock_guard lock(guard_);
    auto store = std::make_shared<OpenedStore>(path);
    return stores_.emplace(store->id(), store).first->second->id();
  }
  throw Error(ErrorKind::kUsage, name, "there are very many stores of this name", "Give it another name");
}

std::string Stores::create(const std::string& name) {
  const fs::path path = folder_.stores() / (tame(name, 60) + ".freshet");
  const std::lock_guard lock(guard_);
  auto store = std::make_shared<OpenedStore>(path);
  stores_.emplace(store->id(), store);
  return store->id();
}

fs::path Stores::clip_path(const std::string& store, const std::string& class_name, const std::string& file) {
  store::expect_one_store(get(store)->path());
  if (!media::looks_like_video(file))
    throw Error(ErrorKind::kUsage, file, "its ending names no video", "Give MP4, MOV, MKV, AVI or WebM");
  const fs::path folder =
      folder_.incoming_clips(get(store)->id()) / tame(class_name.empty() ? "unsorted" : class_name, 40);
  make_folder(folder);
  return folder / tame(fs::path(file).filename(), 100);
}

JobId Stores::ingest(const std::string& id, const std::string& licence) {
  const std::shared_ptr<OpenedStore> store = get(id);
  const fs::path clips = folder_.incoming_clips(id);
  return jobs_.commands().submit(
      "ingest " + id, "Ingest into " + store->path().stem().string(),
      [this, store, clips, licence, id](const Job& job) {
        work::Command command{.program = program_,
                              .arguments = {"ingest", store->path(), clips, "--json"},
                              .folder = folder_.path()};
        if (!licence.empty()) command.arguments.push_back("--licence=" + licence);
        const work::CommandAnswer answer =
            work::run_to_end(command, job);  // what is stopped or fails keeps its clips
        Json report = Json::parse(answer.output, nullptr, false);
        if (!only_refused(report)) work::expect_done(command, answer);
        store->refresh();
        add_strips(clips, report);
        std::error_code fault;
        fs::remove_all(clips, fault);
        jobs_.feed().publish("ingested",
                             json_text({{"store", id}, {"report", report.is_discarded() ? Json() : report}}));
      });
}

void Stores::add_strips(const fs::path& clips, Json& report) {
  constexpr std::size_t kMostStrips = 60;
  constexpr int kWidth = 240;  // px
  std::map<std::uint64_t, std::string> strips;
  if (report.is_object() && report.contains("clips"))
    for (Json& clip : report["clips"]) {
      if (strips.size() >= kMostStrips) break;
      // What ingest could not decode, in a process of its own, is not tried in this one.
      if (clip.value("frames", 0) < 1) continue;
      try {
        const fs::path video = clips / clip.at("name").get<std::string>();
        const std::uint64_t number = next_number();
        strips[number] = encoded(clip_strip(video, kWidth));
        clip["strip"] = number;
      } catch (const std::exception&) {
        continue;  // what cannot be decoded cannot be shown; why is said in words
      }
    }
  const std::lock_guard lock(guard_);
  strips_ = std::move(strips);
}

std::string Stores::screened_strip(std::uint64_t number) const {
  const std::lock_guard lock(guard_);
  const auto found = strips_.find(number);
  if (found == strips_.end()) throw Error(ErrorKind::kNotFound, "clip", "it is no longer there");
  return found->second;
}

}  // namespace freshet::studio
