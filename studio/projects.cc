#include "studio/projects.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/text.h"
#include "platform/whole_file.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::size_t kMostEasels = 2;  // each holds a picture, its mattes and its frames
constexpr std::uintmax_t kCacheBytes = std::uintmax_t{1} << 30;

/// What is wrong with a file is said by the name that a person knows. path   that it has here.
[[noreturn]] void rethrow_named(const Error& fault, const std::string& path, const std::string& name) {
  const std::string text = fault.what();
  if (name.empty() || !text.starts_with(path + ": ") || !text.ends_with('.')) throw fault;
  throw Error(fault.kind(), name, text.substr(path.size() + 2, text.size() - path.size() - 3));
}

std::shared_ptr<Project> create_project(const fs::path& folder, const fs::path& file, const std::string& name,
                                        const std::string& ending) {
  try {
    return Project::create(folder, file, ending);
  } catch (const Error& fault) {
    rethrow_named(fault, folder / ("picture" + ending), name);
  }
}

std::string takes_key(const std::string& project) { return "takes " + project; }
std::string layers_key(const std::string& project) { return "layers " + project; }

/// What a project is given and what is drawn for it. Left out are links, files that are being written
/// (write_beneath), and what goes meanwhile. to   an empty folder.
void copy_drawn(const fs::path& from, const fs::path& to) {
  for (auto at = fs::recursive_directory_iterator(from); at != fs::recursive_directory_iterator(); ++at) {
    const fs::path within = at->path().lexically_relative(from);
    const bool given = *within.begin() != "exports" &&
                       (*within.begin() != "ways" || within.string().starts_with("ways/stills") ||
                        within.string().starts_with("ways/flowlines") || within == "ways");
    if (at->is_symlink() || !given) {
      if (at->is_directory()) at.disable_recursion_pending();
    } else if (at->is_directory()) {
      fs::create_directory(to / within);
    } else if (at->is_regular_file() && within.extension() != ".new") {
      std::error_code fault;
      if (!fs::copy_file(at->path(), to / within, fault) && fault != std::errc::no_such_file_or_directory)
        throw fs::filesystem_error("copy_file", fault);
    }
  }
}

}  // namespace

Projects::Projects(StudioFolder& folder, Jobs& jobs, Stores& stores)
    : folder_(folder), jobs_(jobs), stores_(stores), cache_(folder.cache(), kCacheBytes) {}

Json Projects::list() const {
  std::vector<std::pair<fs::file_time_type, std::string>> found;
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_.projects(), fault)) {
    const std::string id = entry.path().filename();
    if (!is_project_name(id) || entry.is_symlink() || !entry.is_directory()) continue;
    const fs::file_time_type changed = fs::last_write_time(entry.path() / "document.json", fault);
    if (!fault) found.emplace_back(changed, id);
  }
  std::sort(found.rbegin(), found.rend());
  Json list = Json::array();
  for (const auto& [changed, id] : found) {
    const auto ago =
        std::chrono::duration_cast<std::chrono::seconds>(fs::file_time_type::clock::now() - changed);
    list.push_back({{"id", id}, {"seconds_ago", ago.count()}});
  }
  return list;
}

fs::path Projects::folder_of(const std::string& id) const {
  if (!is_project_name(id)) throw Error(ErrorKind::kNotFound, "project", "there is no such project");
  return folder_.projects() / id;
}

std::string Projects::open_picture(const fs::path& file, const std::string& name, const std::string& store) {
  const std::string stem = project_name(name), ending = lower_ending(name);
  const std::lock_guard lock(guard_);
  for (int number = 1; number < 1000; ++number) {
    const std::string id = number == 1 ? stem : fmt::format("{}-{}", stem, number);
    const fs::path folder = folder_of(id);
    if (!fs::exists(fs::symlink_status(folder))) {
      const std::shared_ptr<Project> project = create_project(folder, file, name, ending);
      Document document;
      const bool transparent = !project->picture()->alpha.empty();
      if (transparent) document.matte_base = MatteBase::kAlpha;
      document.store = store.empty() ? stores_.likely() : store;
      project->save(document, 0);
      return id;
    }
    try {
      if (same_bytes(folder / Project(folder).picture_file(), file)) return id;
    } catch (const Error&) {
      continue;  // something else of this name lies there
    }
  }
  throw Error(ErrorKind::kUsage, name, "there are very many projects of this name", "Give it another name");
}

void Projects::stop_previews(const std::string& id) {
  jobs_.previews().stop_key(id);
  jobs_.previews().stop_key(takes_key(id));
  jobs_.live().stop_key(layers_key(id));
}

void Projects::forget(const std::string& id) {
  easels_.erase(id);
  std::erase_if(kept_, [&](const auto& each) { return each.first == id; });
}

void Projects::remove(const std::string& id) {
  const fs::path folder = folder_of(id);
  stop_previews(id);
  const std::lock_guard lock(guard_);
  forget(id);
  if (fs::is_symlink(fs::symlink_status(folder)) || !fs::is_directory(folder))
    throw Error(ErrorKind::kNotFound, id, "there is no such project");
  std::error_code fault;
  fs::remove_all(folder, fault);
  if (fault)
    throw Error(ErrorKind::kIo, folder.string(), fmt::format("cannot be removed ({})", fault.message()),
                "Check its permissions, then remove it again");
}

std::string Projects::rename(const std::string& id, const std::string& name) {
  const std::string wanted = project_name(name);
  const fs::path from = folder_of(id), to = folder_of(wanted);
  if (wanted == id) return id;
  stop_previews(id);
  const std::lock_guard lock(guard_);
  if (fs::is_symlink(fs::symlink_status(from)) || !fs::is_directory(from))
    throw Error(ErrorKind::kNotFound, id, "there is no such project");
  if (fs::exists(fs::symlink_status(to)))
    throw Error(ErrorKind::kUsage, name, "another project has this name", "Choose another");
  forget(id);
  std::error_code fault;
  fs::rename(from, to, fault);
  if (fault) throw Error(ErrorKind::kIo, to.string(), "the folder cannot be renamed");
  return wanted;
}

std::string Projects::duplicate(const std::string& id, int longest) {
  if (longest > 0) return reduced(id, longest);
  const fs::path from = folder_of(id);
  const std::lock_guard lock(guard_);
  if (fs::is_symlink(fs::symlink_status(from)) || !fs::is_directory(from))
    throw Error(ErrorKind::kNotFound, id, "there is no such project");
  for (int number = 2; number < 1000; ++number) {
    const std::string copy = fmt::format("{}-{}", id, number);
    const fs::path to = folder_of(copy);
    std::error_code fault;
    if (!fs::create_directory(to, fault)) {
      if (fs::exists(fs::symlink_status(to))) continue;
      throw Error(ErrorKind::kIo, to.string(), fmt::format("cannot be made ({})", fault.message()),
                  "Check the folder and the disk");
    }
    try {
      copy_drawn(from, to);
    } catch (const fs::filesystem_error& failed) {
      fs::remove_all(to, fault);
      throw Error(ErrorKind::kIo, id, fmt::format("it cannot be copied ({})", failed.code().message()));
    }
    return copy;
  }
  throw Error(ErrorKind::kUsage, id, "there are very many projects of this name", "Rename it");
}

std::string Projects::reduced(const std::string& id, int longest) {
  const std::shared_ptr<Easel> easel = this->easel(id);
  const std::shared_ptr<const media::Still> still = easel->project().picture();
  const cv::Size size = still->bgr.size();
  const double factor = std::max(size.width, size.height) / static_cast<double>(longest);
  if (factor <= 1) throw Error(ErrorKind::kUsage, id, "its picture is not larger than that");
  // All of its bits, and its alpha: the file is read again.
  cv::Mat small = cv::imread((easel->project().folder() / easel->project().picture_file()).string(),
                             cv::IMREAD_UNCHANGED | cv::IMREAD_IGNORE_ORIENTATION);
  if (small.size() != size || small.depth() == CV_32F || (small.channels() != 3 && small.channels() != 4))
    small = still->bgr;  // turned upright, or light that PNG does not hold
  cv::resize(small, small,
             {std::max(1, cvRound(size.width / factor)), std::max(1, cvRound(size.height / factor))}, 0, 0,
             cv::INTER_AREA);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", small, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  const IncomingFile file = folder_.incoming_file();
  write_whole_file(file.path(), {bytes.begin(), bytes.end()});
  return open_picture(file.path(), fmt::format("{}-{}.png", id, longest),
                      easel->project().state().document.store);
}

std::shared_ptr<Easel> Projects::easel(const std::string& project) {
  const std::lock_guard lock(guard_);
  const fs::path folder = folder_of(project);
  const auto known = easels_.find(project);
  std::shared_ptr<Easel> easel = known != easels_.end() ? known->second.lock() : nullptr;
  if (!easel) {
    if (!fs::exists(fs::symlink_status(folder)))
      throw Error(ErrorKind::kNotFound, project, "there is no such project");
    easel = std::make_shared<Easel>(
        std::make_shared<Project>(folder),
        [this](const std::string& type, const std::string& data) { jobs_.feed().publish(type, data); });
  }
  forget(project);
  std::erase_if(easels_, [](const auto& each) { return each.second.expired(); });
  easels_[project] = easel;
  kept_.emplace_back(project, easel);
  if (kept_.size() > kMostEasels) kept_.erase(kept_.begin());
  return easel;
}

std::string Projects::to_json(const std::string& project) {
  const std::shared_ptr<Easel> easel = this->easel(project);
  const Project::State state = easel->project().state();
  const cv::Size size = easel->project().size();
  if (!jobs_.previews().is_busy_with(project)) update(project);
  return json_text({{"id", project},
                    {"folder", easel->project().folder().string()},
                    {"width", size.width},
                    {"height", size.height},
                    {"alpha", !easel->project().picture()->alpha.empty()},
                    {"notices", easel->project().picture()->notices},
                    {"notice", easel->project().notice()},
                    {"document", Json::parse(studio::to_json(state.document))},
                    {"version", state.version},
                    {"event", jobs_.feed().last()},
                    {"made", Json::parse(easel->overview_json())}});
}

Projects::Saved Projects::save(const std::string& project, std::string_view json, std::uint64_t base,
                               const std::string& page) {
  const std::shared_ptr<Easel> easel = this->easel(project);
  const Document document = document_from_json(json, "document");
  // A page may name only what is open here: a store's path is one of the disk.
  if (!document.store.empty() && !stores_.at(document.store) &&
      document.store != easel->project().state().document.store)
    throw Error(ErrorKind::kUsage, document.store, "this store is not open", "Give it to freshet studio");
  const std::optional<std::uint64_t> version = easel->project().save(document, base);
  if (!version) {
    const Project::State now = easel->project().state();
    return {.taken = false,
            .json = json_text(
                {{"version", now.version}, {"document", Json::parse(studio::to_json(now.document))}})};
  }
  jobs_.feed().publish("document", json_text({{"project", project}, {"version", *version}, {"page", page}}));
  const JobId job = update(project);
  return {.taken = true, .json = json_text({{"version", *version}, {"job", job}})};
}

void Projects::give_matte(const std::string& project, const fs::path& file, const std::string& name) {
  try {
    easel(project)->project().give_matte(file);
  } catch (const Error& fault) {
    rethrow_named(fault, file, name);
  }
}

JobId Projects::find_takes(const std::string& project) {
  const std::shared_ptr<Easel> easel = this->easel(project);
  return jobs_.previews().submit(takes_key(project), "Takes",
                                 [easel](const Job& job) { easel->find_takes(job); });
}

JobId Projects::show_layers(const std::string& project, int first) {
  const std::shared_ptr<Easel> easel = this->easel(project);
  return jobs_.live().submit(layers_key(project), "Layers",
                             [easel, first](const Job& job) { easel->show_layers(first, job); });
}

JobId Projects::update(const std::string& project) {
  jobs_.previews().stop_key(takes_key(project));
  const std::shared_ptr<Easel> easel = this->easel(project);
  const std::shared_ptr<OpenedStore> store = stores_.at(easel->project().state().document.store);
  return jobs_.previews().submit(project, "Preview", [this, easel, store](const Job& job) {
    easel->bring_up_to_date(store.get(), &cache_, job);
  });
}

void Projects::await_previews(const std::string& project, const Easel& easel, const Job& job) {
  Document now;
  const auto has_matte = [&] {
    now = easel.project().state().document;
    const std::shared_ptr<const FoundMatte> matte = easel.matte();
    return matte && matte->key == matte_key(now) && !matte->alpha.empty();
  };
  const auto has_pieces = [&] { return now.pins.empty() || easel.is_labelled(now); };
  // One that has made room for others kept nothing of what was made.
  if (!jobs_.previews().is_busy_with(project) && !(has_matte() && has_pieces())) update(project);
  // What was drawn last is made, not what was there before it: the matte and pinned pieces are made by previews.
  while (jobs_.previews().is_busy_with(project)) {
    if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, project, "stopped");
    if (job.progress) job.progress({"waiting for the preview", 0, 0});
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  if (!has_matte()) throw Error(ErrorKind::kUsage, project, "it has no matte", "Say what flows");
  if (!has_pieces())
    throw Error(ErrorKind::kUsage, project, "its pieces were not chosen", "See what the preview says");
}

}  // namespace freshet::studio
