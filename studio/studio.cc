#include "studio/studio.h"

#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <optional>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "platform/text.h"
#include "platform/whole_file.h"
#include "studio/clip_folder.h"
#include "studio/clip_strip.h"
#include "studio/still_folder.h"
#include "synth/scene/scene_file.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::size_t kMostEasels = 2;  // each holds a picture, its mattes and its frames
constexpr std::uintmax_t kCacheBytes = std::uintmax_t{1} << 30;

std::string text(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

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

Json view_json(const JobView& view, const char* lane) {
  return {{"lane", lane},
          {"id", view.id},
          {"key", view.key},
          {"title", view.title},
          {"state", to_string(view.state)},
          {"stage", view.progress.stage},
          {"done", view.progress.done},
          {"of", view.progress.of},
          {"fault", view.fault}};
}

/// A folder of pictures that were exported.
Json sequence_json(const fs::directory_entry& folder) {
  std::uintmax_t bytes = 0;
  std::size_t pictures = 0;
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, fault)) {
    if (entry.is_symlink() || !entry.is_regular_file()) continue;
    bytes += entry.file_size();
    ++pictures;
  }
  return {{"name", folder.path().filename().string()}, {"bytes", bytes}, {"pictures", pictures}};
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

Studio::Studio(StudioOptions options) : options_(std::move(options)), folder_(options_.folder) {
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_.stores(), fault))
    if (entry.path().extension() == ".freshet" && entry.is_regular_file()) add_store(entry.path());
  for (const fs::path& path : options_.stores) add_store(path);
  cache_ = std::make_unique<cache::ResultCache>(folder_.cache(), kCacheBytes);
  previews_ = std::make_unique<JobQueue>(watcher("preview"));
  commands_ = std::make_unique<JobQueue>(watcher("command"));
}

Studio::~Studio() { feed_.close(); }

JobQueue::Watcher Studio::watcher(const char* lane) {
  return [this, lane](const JobView& view) { feed_.publish("job", text(view_json(view, lane))); };
}

void Studio::add_store(const fs::path& path) {
  auto store = std::make_shared<OpenedStore>(fs::weakly_canonical(path));
  if (store->exists()) store->snapshot();  // what is wrong with it is said when it is opened
  stores_.emplace(store->id(), store);
}

fs::path Studio::project_folder(const std::string& id) const {
  if (!is_project_name(id)) throw Error(ErrorKind::kNotFound, "project", "there is no such project");
  return folder_.projects() / id;
}

namespace {

/// What an export can be: rows of the table of endings that are offered.
Json offered_formats() {
  Json formats = Json::array();
  for (const media::FileFormat& each : media::file_formats()) {
    if (each.name.empty()) continue;
    Json depths = Json::array();
    for (const media::Depth depth : media::kDepths)
      if (each.depths.has(depth)) depths.push_back(to_string(depth));
    formats.push_back({{"ending", each.ending},
                       {"name", each.name},
                       {"use", each.use},
                       {"alpha", each.alpha},
                       {"sequence", each.kind == media::FormatKind::kPicture},
                       {"depths", depths}});
  }
  return formats;
}

}  // namespace

std::string Studio::home_json() const {
  std::vector<std::pair<fs::file_time_type, std::string>> found;
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_.projects(), fault)) {
    const std::string id = entry.path().filename();
    if (!is_project_name(id) || entry.is_symlink() || !entry.is_directory()) continue;
    const fs::file_time_type changed = fs::last_write_time(entry.path() / "document.json", fault);
    if (!fault) found.emplace_back(changed, id);
  }
  std::sort(found.rbegin(), found.rend());
  Json json{{"projects", Json::array()},
            {"stores", Json::array()},
            {"folder", folder_.path().string()},
            {"formats", offered_formats()},
            {"ranges", Json::object()}};
  for (const synth::scene::SceneRange& each : synth::scene::scene_ranges())
    json["ranges"][each.table + "." + each.key] = {each.slider.low, each.slider.high};
  for (const auto& [changed, id] : found) {
    const auto ago =
        std::chrono::duration_cast<std::chrono::seconds>(fs::file_time_type::clock::now() - changed);
    json["projects"].push_back({{"id", id}, {"seconds_ago", ago.count()}});
  }
  std::map<std::string, std::shared_ptr<OpenedStore>> stores;
  {
    const std::lock_guard lock(guard_);
    stores = stores_;
  }
  for (const auto& [id, store] : stores) json["stores"].push_back(Json::parse(store->to_json()));
  return text(json);
}

std::string Studio::open_picture(const fs::path& file, const std::string& name, const std::string& store) {
  const std::string stem = project_name(name), ending = lower_ending(name);
  const std::lock_guard lock(guard_);
  for (int number = 1; number < 1000; ++number) {
    const std::string id = number == 1 ? stem : fmt::format("{}-{}", stem, number);
    const fs::path folder = project_folder(id);
    if (!fs::exists(fs::symlink_status(folder))) {
      const std::shared_ptr<Project> project = Project::create(folder, file, ending);
      Document document;
      const bool transparent = !project->picture()->alpha.empty();
      if (transparent) document.matte_base = MatteBase::kAlpha;
      document.store = store.empty() ? likely_store() : store;
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

std::string Studio::likely_store() const {
  if (!options_.stores.empty()) return fs::weakly_canonical(options_.stores.front());
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

void Studio::remove_project(const std::string& id) {
  const fs::path folder = project_folder(id);
  previews_->stop_key(id);
  const std::lock_guard lock(guard_);
  easels_.erase(id);
  if (fs::is_symlink(fs::symlink_status(folder)) || !fs::is_directory(folder))
    throw Error(ErrorKind::kNotFound, id, "there is no such project");
  std::error_code fault;
  fs::remove_all(folder, fault);
}

std::shared_ptr<Easel> Studio::easel(const std::string& project) {
  const std::lock_guard lock(guard_);
  const fs::path folder = project_folder(project);
  std::erase(recently_, project);
  recently_.push_back(project);
  const auto found = easels_.find(project);
  if (found != easels_.end()) return found->second;
  if (!fs::exists(fs::symlink_status(folder))) {
    std::erase(recently_, project);
    throw Error(ErrorKind::kNotFound, project, "there is no such project");
  }
  auto opened = std::make_shared<Easel>(
      std::make_shared<Project>(folder),
      [this](const std::string& type, const std::string& data) { feed_.publish(type, data); });
  while (recently_.size() > kMostEasels) {
    easels_.erase(recently_.front());
    recently_.erase(recently_.begin());
  }
  easels_[project] = opened;
  return opened;
}

std::string Studio::project_json(const std::string& project) {
  const std::shared_ptr<Easel> easel = this->easel(project);
  const Project::State state = easel->project().state();
  const cv::Size size = easel->project().size();
  if (!previews_->is_busy_with(project)) update(project);
  return text({{"id", project},
               {"folder", easel->project().folder().string()},
               {"width", size.width},
               {"height", size.height},
               {"alpha", !easel->project().picture()->alpha.empty()},
               {"notices", easel->project().picture()->notices},
               {"notice", easel->project().notice()},
               {"document", Json::parse(to_json(state.document))},
               {"version", state.version},
               {"event", feed_.last()},
               {"made", Json::parse(easel->overview_json())}});
}

std::shared_ptr<OpenedStore> Studio::store_at(const std::string& path) const {
  const std::lock_guard lock(guard_);
  for (const auto& [id, store] : stores_)
    if (store->path() == path) return store;
  return nullptr;
}

Studio::Saved Studio::save_document(const std::string& project, std::string_view json, std::uint64_t base,
                                    const std::string& page) {
  const std::shared_ptr<Easel> easel = this->easel(project);
  const Document document = document_from_json(json, "document");
  // A page may name only what is open here: a store's path is one of the disk.
  if (!document.store.empty() && !store_of(document) &&
      document.store != easel->project().state().document.store)
    throw Error(ErrorKind::kUsage, document.store, "this store is not open", "Give it to freshet studio");
  const std::optional<std::uint64_t> version = easel->project().save(document, base);
  if (!version) {
    const Project::State now = easel->project().state();
    return {.taken = false,
            .json = text({{"version", now.version}, {"document", Json::parse(to_json(now.document))}})};
  }
  feed_.publish("document", text({{"project", project}, {"version", *version}, {"page", page}}));
  const JobId job = update(project);
  return {.taken = true, .json = text({{"version", *version}, {"job", job}})};
}

void Studio::give_matte(const std::string& project, const fs::path& file) {
  easel(project)->project().give_matte(file);
}

JobId Studio::update(const std::string& project) {
  const std::shared_ptr<Easel> easel = this->easel(project);
  const std::shared_ptr<OpenedStore> store = store_of(easel->project().state().document);
  return previews_->submit(project, "Preview", [this, easel, store](const Job& job) {
    easel->bring_up_to_date(store.get(), cache_.get(), job);
  });
}

Command Studio::export_command(const std::string& program, const Project& project, const std::string& name,
                               const std::vector<std::string>& options) {
  Command command{
      .program = program,
      .arguments = {"synth", "animate", "--config", "project.toml", "-o", Project::export_output(name)},
      .folder = project.folder()};
  command.arguments.insert(command.arguments.end(), options.begin(), options.end());
  return command;
}

JobId Studio::export_animation(const std::string& project, const std::string& name,
                               const std::vector<std::string>& options) {
  const std::shared_ptr<Easel> easel = this->easel(project);
  easel->project().expect_export(name);  // refused here, not minutes later
  const Document document = easel->project().state().document;
  const std::shared_ptr<OpenedStore> store = store_of(document);
  if (!store) throw Error(ErrorKind::kUsage, project, "no store is chosen", "Choose one");
  std::vector<std::string> words = options;
  words.emplace_back("--overwrite");
  return commands_->submit("export " + project + "/" + name, "Export " + name,
                           [this, easel, project, name, words](const Job& job) {
                             await_previews(project, *easel, job);
                             expect_no_links(easel->project().folder());
                             run(export_command(options_.program, easel->project(), name, words), job);
                             feed_.publish("export", text({{"project", project}, {"name", name}}));
                           });
}

void Studio::await_previews(const std::string& project, const Easel& easel, const Job& job) const {
  // What was drawn last is made, not what was there before it: the matte and pinned pieces are made by previews.
  while (previews_->is_busy_with(project)) {
    if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, project, "stopped");
    if (job.progress) job.progress({"waiting for the preview", 0, 0});
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  const Document now = easel.project().state().document;
  const std::shared_ptr<const FoundMatte> matte = easel.matte();
  if (!matte || matte->key != matte_key(now) || matte->alpha.empty())
    throw Error(ErrorKind::kUsage, project, "it has no matte", "Say what flows");
  if (!now.pins.empty() && !easel.is_labelled(now))
    throw Error(ErrorKind::kUsage, project, "its pieces were not chosen", "See what the preview says");
}

std::string Studio::exports_json(const std::string& project) {
  const std::shared_ptr<Easel> easel = this->easel(project);
  Json json{{"files", Json::array()}, {"folder", easel->project().folder().string()}};
  std::error_code fault;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(easel->project().folder() / "exports", fault)) {
    const std::string name = entry.path().filename();
    if (!is_plain_file_name(name) || entry.is_symlink()) continue;
    if (entry.is_regular_file())
      json["files"].push_back({{"name", name}, {"bytes", entry.file_size()}, {"pictures", 0}});
    if (entry.is_directory()) json["files"].push_back(sequence_json(entry));
  }
  return text(json);
}

WayPlan Studio::plan(const std::string& project, const std::string& way) {
  const std::shared_ptr<Easel> easel = this->easel(project);
  return plan_way(way, easel->project().state().document);
}

JobId Studio::run_way(const std::string& project, const std::string& way) {
  const std::shared_ptr<Easel> easel = this->easel(project);
  // What is drawn now is what is made, whatever is drawn while it waits.
  const Document document = easel->project().state().document;
  const WayPlan plan = plan_way(way, document);
  // A document may come from elsewhere, and name any store of the disk.
  if (!plan.store.empty() && !store_at(plan.store))
    throw Error(ErrorKind::kUsage, plan.store, "this store is not open", "Give it to freshet studio");
  return commands_->submit(
      "way " + project + "/" + way, project + ": " + way,
      [this, easel, document, plan, project, way](const Job& job) {
        if (plan.animates) await_previews(project, *easel, job);
        Project& holder = easel->project();
        holder.write_way(plan.folder,
                         way_files(way, document, holder.picture()->bgr, holder.recipe_files(document)));
        if (plan.animates) {
          // Its films are made one by one: what was found of those before them does not say what they show.
          holder.write_way(plan.folder, {{plan.answer, "null"}});
          tell_way(project, way);
        }
        CommandAnswer answer;
        expect_no_links(holder.folder());
        for (const std::vector<std::string>& words : plan.commands)
          answer = run({.program = options_.program, .arguments = words, .folder = holder.folder()}, job);
        if (!plan.answer.empty()) holder.write_way(plan.folder, {{plan.answer, answer.output}});
        tell_way(project, way);
      });
}

void Studio::tell_way(const std::string& project, const std::string& way) {
  feed_.publish("way", text({{"project", project}, {"way", way}}));
}

std::shared_ptr<const OpenFile> Studio::film(const std::string& project, const std::string& way) {
  return open_beneath(easel(project)->project().folder(), plan(project, way).film);
}

std::shared_ptr<const OpenFile> Studio::way_file(const std::string& project, const std::string& way,
                                                 const std::string& name) {
  const WayPlan plan = this->plan(project, way);
  if (std::find(plan.shown.begin(), plan.shown.end(), name) == plan.shown.end())
    throw Error(ErrorKind::kNotFound, name, "there is no such file");
  return easel(project)->project().open_way(plan.folder, name);
}

std::string Studio::layer_matte_png(const std::string& project, std::uint64_t layer) {
  constexpr int kLongest = 1024;  // px
  const std::shared_ptr<Easel> easel = this->easel(project);
  const Document drawn = easel->project().state().document;
  if (layer >= drawn.layered.layers.size())
    throw Error(ErrorKind::kNotFound, "layer", "there is no such layer");
  Document scribbles;
  scribbles.scribbles = drawn.layered.layers[layer].paint;
  const std::optional<DrawnMatte> matte =
      draw_matte(scribbles, easel->project().picture()->bgr, {}, {}, Care::kDraft);
  if (!matte) throw Error(ErrorKind::kNotFound, "layer", "nothing is scribbled on it");
  return easel->matte_png(matte->alpha, kLongest);
}

std::string Studio::stills_json(const std::string& project) {
  return text(still_names(easel(project)->project().folder()));
}

std::string Studio::still_thumbnail(const std::string& project, const std::string& name) {
  return studio::still_thumbnail(easel(project)->project().folder(), name);
}

void Studio::add_still(const std::string& project, const fs::path& file, const std::string& name) {
  studio::add_still(easel(project)->project().folder(), file, name);
  tell_way(project, "stills");
}

void Studio::remove_stills(const std::string& project) {
  studio::remove_stills(easel(project)->project().folder());
  tell_way(project, "stills");
}

std::string Studio::way_json(const std::string& project, const std::string& way) {
  const WayPlan plan = this->plan(project, way);
  Json json{{"film", nullptr},
            {"made", nullptr},
            {"commands", Json::array()},
            {"found", nullptr},
            {"shown", plan.shown}};
  for (const std::vector<std::string>& words : plan.commands)
    json["commands"].push_back(to_text({.program = {}, .arguments = words, .folder = {}}));
  try {
    if (!plan.answer.empty()) {
      const std::shared_ptr<Easel> easel = this->easel(project);
      const Json found = Json::parse(easel->project().read_way(plan.folder, plan.answer), nullptr, false);
      if (!found.is_discarded()) {
        json["found"] = found;
        json["made"] = std::to_string(easel->project().open_way(plan.folder, plan.answer)->changed_ns());
      }
    }
    if (!plan.film.empty()) json["film"] = std::to_string(film(project, way)->changed_ns());
  } catch (const Error&) {
    return text(json);  // there is none yet
  }
  return text(json);
}

std::string Studio::add_clip(const std::string& project, const fs::path& file, const std::string& name) {
  try {
    first_frame(file);
  } catch (const Error&) {
    throw Error(ErrorKind::kInput, name, "it is no video that can be read",
                "Give MP4, MOV, MKV, AVI or WebM");
  }
  return studio::add_clip(easel(project)->project().folder(), file, name);
}

std::string Studio::clips_json(const std::string& project) {
  return text(clip_names(easel(project)->project().folder()));
}

std::string Studio::clip_frame(const std::string& project, const std::string& clip, bool own) {
  const std::shared_ptr<Easel> easel = this->easel(project);
  if (own) {
    const fs::path folder = easel->project().folder();
    const std::vector<std::string> names = clip_names(folder);
    if (std::find(names.begin(), names.end(), clip) == names.end())
      throw Error(ErrorKind::kNotFound, clip, "there is no such clip");
    return encoded(first_frame(folder / own_clip_path(clip)));
  }
  const std::shared_ptr<OpenedStore> store = store_of(easel->project().state().document);
  if (!store) throw Error(ErrorKind::kNotFound, clip, "no store is chosen");
  return encoded(first_frame(store->snapshot(), clip));
}

std::string Studio::open_clip(const fs::path& file, const std::string& name) {
  if (!media::looks_like_video(name))
    throw Error(ErrorKind::kInput, name, "its ending names no video", "Give MP4, MOV, MKV, AVI or WebM");
  std::vector<std::uint8_t> png;
  cv::imencode(".png", first_frame(file), png);
  const IncomingFile picture = incoming_file();
  write_whole_file(picture.path(), {png.begin(), png.end()});
  const std::string id = open_picture(picture.path(), project_name(name) + ".png");
  const std::shared_ptr<Easel> easel = this->easel(id);  // it is ours while others are opened
  Project::State state = easel->project().state();
  state.document.endless.clip = add_clip(id, file, name);
  state.document.endless.dropped = true;
  easel->project().save(state.document, state.version);
  return id;
}

std::shared_ptr<OpenedStore> Studio::store(const std::string& id) const {
  const std::lock_guard lock(guard_);
  const auto found = stores_.find(id);
  if (found == stores_.end()) throw Error(ErrorKind::kNotFound, "store", "there is no such store");
  return found->second;
}

std::string Studio::open_store(const fs::path& file, const std::string& name) {
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

std::string Studio::new_store(const std::string& name) {
  const fs::path path = folder_.stores() / (tame(name, 60) + ".freshet");
  const std::lock_guard lock(guard_);
  auto store = std::make_shared<OpenedStore>(path);
  stores_.emplace(store->id(), store);
  return store->id();
}

fs::path Studio::clip_path(const std::string& store, const std::string& class_name, const std::string& file) {
  if (!media::looks_like_video(file))
    throw Error(ErrorKind::kUsage, file, "its ending names no video", "Give MP4, MOV, MKV, AVI or WebM");
  const fs::path folder = folder_.incoming_clips(this->store(store)->id()) /
                          tame(class_name.empty() ? "unsorted" : class_name, 40);
  make_folder(folder);
  return folder / tame(fs::path(file).filename(), 100);
}

JobId Studio::ingest(const std::string& id, const std::string& licence) {
  const std::shared_ptr<OpenedStore> store = this->store(id);
  const fs::path clips = folder_.incoming_clips(id);
  return commands_->submit(
      "ingest " + id, "Ingest into " + store->path().stem().string(),
      [this, store, clips, licence, id](const Job& job) {
        Command command{.program = options_.program,
                        .arguments = {"ingest", store->path(), clips, "--json"},
                        .folder = folder_.path()};
        if (!licence.empty()) command.arguments.push_back("--licence=" + licence);
        const CommandAnswer answer = run_to_end(command, job);  // what is stopped or fails keeps its clips
        Json report = Json::parse(answer.output, nullptr, false);
        if (!only_refused(report)) expect_done(command, answer);
        store->refresh();
        add_strips(clips, report);
        std::error_code fault;
        fs::remove_all(clips, fault);
        feed_.publish("ingested", text({{"store", id}, {"report", report.is_discarded() ? Json() : report}}));
      });
}

void Studio::add_strips(const fs::path& clips, Json& report) {
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

std::string Studio::screened_strip(std::uint64_t number) const {
  const std::lock_guard lock(guard_);
  const auto found = strips_.find(number);
  if (found == strips_.end()) throw Error(ErrorKind::kNotFound, "clip", "it is no longer there");
  return found->second;
}

std::string Studio::jobs_json() const {
  Json json = Json::array();
  for (const JobView& view : previews_->jobs()) json.push_back(view_json(view, "preview"));
  for (const JobView& view : commands_->jobs()) json.push_back(view_json(view, "command"));
  return text(json);
}

bool Studio::stop_job(const std::string& lane, JobId id) {
  return lane == "preview" ? previews_->stop(id) : commands_->stop(id);
}

void Studio::wait() {
  previews_->wait();
  commands_->wait();
}

}  // namespace freshet::studio
