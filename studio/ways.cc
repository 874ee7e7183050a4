#include "studio/ways.h"

#include <algorithm>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "platform/whole_file.h"
#include "studio/clip_folder.h"
#include "studio/clip_strip.h"
#include "studio/still_folder.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

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

}  // namespace

Ways::Ways(StudioFolder& folder, Jobs& jobs, Stores& stores, Projects& projects, fs::path program)
    : folder_(folder), jobs_(jobs), stores_(stores), projects_(projects), program_(std::move(program)) {}

work::Command Ways::export_command(const std::string& program, const Project& project,
                                   const std::string& name, const std::vector<std::string>& options) {
  work::Command command{
      .program = program,
      .arguments = {"synth", "animate", "--config", "project.toml", "-o", Project::export_output(name)},
      .folder = project.folder()};
  command.arguments.insert(command.arguments.end(), options.begin(), options.end());
  return command;
}

JobId Ways::export_animation(const std::string& project, const std::string& name,
                             const std::vector<std::string>& options) {
  const std::shared_ptr<Easel> easel = projects_.easel(project);
  easel->project().expect_export(name);  // refused here, not minutes later
  const Document document = easel->project().state().document;
  const std::shared_ptr<OpenedStore> store = stores_.at(document.store);
  if (!store) throw Error(ErrorKind::kUsage, project, "no store is chosen", "Choose one");
  std::vector<std::string> words = options;
  words.emplace_back("--overwrite");
  return jobs_.commands().submit(
      "export " + project + "/" + name, "Export " + name,
      [this, easel, project, name, words](const Job& job) {
        projects_.await_previews(project, *easel, job);
        expect_no_links(easel->project().folder());
        work::run(export_command(program_, easel->project(), name, words), job);
        jobs_.feed().publish("export", json_text({{"project", project}, {"name", name}}));
      });
}

std::string Ways::exports_json(const std::string& project) {
  const std::shared_ptr<Easel> easel = projects_.easel(project);
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
  return json_text(json);
}

WayPlan Ways::plan(const std::string& project, const std::string& way) {
  const std::shared_ptr<Easel> easel = projects_.easel(project);
  return way_of(way).plan(easel->project().state().document);
}

JobId Ways::run(const std::string& project, const std::string& way) {
  const std::shared_ptr<Easel> easel = projects_.easel(project);
  const Document document = easel->project().state().document;
  return submit(easel, way_of(way), document, way_of(way).plan(document), {});
}

std::string Ways::export_film(const std::string& project, const std::string& way, const std::string& name,
                              bool alone) {
  const std::shared_ptr<Easel> easel = projects_.easel(project);
  const Document document = easel->project().state().document;
  WayPlan plan = way_of(way).plan(document);
  easel->project().expect_export(name);
  const std::string output = Project::export_output(name);
  const std::string& replaced = alone ? plan.fluid : plan.film;
  bool is_named = false;
  for (std::vector<std::string>& words : plan.commands)
    for (std::string& word : words)
      if (word == replaced) word = output, is_named = true;
  if (alone && plan.layers) {
    plan.commands.back().insert(plan.commands.back().end(), {"--layers-out", output});
    is_named = true;
  }
  if (alone && !is_named)
    throw Error(ErrorKind::kUsage, way, "it has no fluid or layers of its own", "Export the film");
  if (!is_named) throw Error(ErrorKind::kUsage, way, "its film is made as MP4 alone", "Save that");
  const JobId job = submit(easel, way_of(way), document, plan, name);
  return json_text(
      {{"job", job},
       {"folder", easel->project().folder().string()},
       {"command", work::to_text({.program = {}, .arguments = plan.commands.back(), .folder = {}})}});
}

JobId Ways::submit(const std::shared_ptr<Easel>& easel, const Way& way, const Document& document,
                   const WayPlan& plan, const std::string& exported) {
  const std::string project = easel->project().id(), name(way.name);
  // A document may come from elsewhere, and name any store of the disk.
  if (!plan.store.empty() && !stores_.at(plan.store))
    throw Error(ErrorKind::kUsage, plan.store, "this store is not open", "Give it to freshet studio");
  // What is drawn now is what is made, whatever is drawn while it waits.
  const auto make = [this, easel, document, &way, plan, project, name, exported](const Job& job) {
    if (plan.animates) projects_.await_previews(project, *easel, job);
    Project& holder = easel->project();
    expect_no_links(holder.folder());  // films may be looked at
    const RecipeFiles files = holder.recipe_files(document);
    holder.write_way(plan.folder, way.files({document, holder.picture()->bgr, files, holder.folder()}));
    if (plan.animates) {
      // Its films are made one by one: what was found of those before them does not say what they show.
      holder.write_way(plan.folder, {{plan.answer, "null"}});
      tell(project, name);
    }
    work::CommandAnswer answer;
    expect_no_links(holder.folder());
    for (const std::vector<std::string>& words : plan.commands)
      answer = work::run({.program = program_, .arguments = words, .folder = holder.folder()}, job);
    if (!exported.empty())
      return jobs_.feed().publish("export", json_text({{"project", project}, {"name", exported}}));
    if (!plan.answer.empty()) holder.write_way(plan.folder, {{plan.answer, answer.output}});
    tell(project, name);
  };
  return exported.empty()
             ? jobs_.commands().submit("way " + project + "/" + name, project + ": " + name, make)
             : jobs_.commands().submit("export " + project + "/" + exported, "Export " + exported, make);
}

void Ways::tell(const std::string& project, const std::string& way) {
  jobs_.feed().publish("way", json_text({{"project", project}, {"way", way}}));
}

std::shared_ptr<const OpenFile> Ways::film(const std::string& project, const std::string& way) {
  return open_beneath(projects_.easel(project)->project().folder(), plan(project, way).film);
}

std::shared_ptr<const OpenFile> Ways::file(const std::string& project, const std::string& way,
                                           const std::string& name) {
  const WayPlan plan = this->plan(project, way);
  if (std::find(plan.shown.begin(), plan.shown.end(), name) == plan.shown.end())
    throw Error(ErrorKind::kNotFound, name, "there is no such file");
  return projects_.easel(project)->project().open_way(plan.folder, name);
}

std::string Ways::layer_matte_png(const std::string& project, std::uint64_t layer) {
  constexpr int kLongest = 1024;  // px
  const std::shared_ptr<Easel> easel = projects_.easel(project);
  const Document drawn = easel->project().state().document;
  if (layer >= drawn.scene.layers.size())
    throw Error(ErrorKind::kNotFound, "layer", "there is no such layer");
  Document scribbles;
  scribbles.scribbles = drawn.scene.layers[layer].paint;
  const std::optional<DrawnMatte> matte =
      draw_matte(scribbles, easel->project().picture()->bgr, {}, {}, Care::kDraft);
  if (!matte) throw Error(ErrorKind::kNotFound, "layer", "nothing is scribbled on it");
  return easel->matte_png(matte->alpha, kLongest);
}

std::string Ways::stills_json(const std::string& project) {
  return json_text(still_names(projects_.easel(project)->project().folder()));
}

std::string Ways::still_jpeg(const std::string& project, const std::string& name) {
  return studio::still_jpeg(projects_.easel(project)->project().folder(), name);
}

std::string Ways::still_thumbnail(const std::string& project, const std::string& name) {
  return studio::still_thumbnail(projects_.easel(project)->project().folder(), name);
}

void Ways::add_still(const std::string& project, const fs::path& file, const std::string& name) {
  studio::add_still(projects_.easel(project)->project().folder(), file, name);
  tell(project, "stills");
}

void Ways::remove_stills(const std::string& project) {
  studio::remove_stills(projects_.easel(project)->project().folder());
  tell(project, "stills");
}

std::string Ways::to_json(const std::string& project, const std::string& way) {
  Json json{{"film", nullptr},           {"made", nullptr}, {"found", nullptr}, {"shown", Json::array()},
            {"commands", Json::array()}, {"lacks", ""},     {"alone", ""}};
  WayPlan plan;
  try {
    plan = this->plan(project, way);
  } catch (const Error& fault) {
    if (fault.kind() != ErrorKind::kUsage) throw;
    json["lacks"] = fault.what();  // an answer, not a fault: nobody has asked for the film yet
    return json_text(json);
  }
  json["shown"] = plan.shown;
  json["alone"] = plan.layers ? "layers" : plan.fluid.empty() ? "" : "fluid";
  for (const std::vector<std::string>& words : plan.commands)
    json["commands"].push_back(work::to_text({.program = {}, .arguments = words, .folder = {}}));
  try {
    if (!plan.answer.empty()) {
      const std::shared_ptr<Easel> easel = projects_.easel(project);
      const Json found = Json::parse(easel->project().read_way(plan.folder, plan.answer), nullptr, false);
      if (!found.is_discarded()) {
        json["found"] = found;
        json["made"] = std::to_string(easel->project().open_way(plan.folder, plan.answer)->changed_ns());
      }
    }
    if (!plan.film.empty()) json["film"] = std::to_string(film(project, way)->changed_ns());
  } catch (const Error&) {
    return json_text(json);  // there is none yet
  }
  return json_text(json);
}

std::string Ways::add_clip(const std::string& project, const fs::path& file, const std::string& name) {
  try {
    first_frame(file);
  } catch (const Error&) {
    throw Error(ErrorKind::kInput, name, "it is no video that can be read",
                "Give MP4, MOV, MKV, AVI or WebM");
  }
  return studio::add_clip(projects_.easel(project)->project().folder(), file, name);
}

std::string Ways::clips_json(const std::string& project) {
  return json_text(clip_names(projects_.easel(project)->project().folder()));
}

std::string Ways::clip_frame(const std::string& project, const std::string& clip, bool own) {
  const std::shared_ptr<Easel> easel = projects_.easel(project);
  if (own) {
    const fs::path folder = easel->project().folder();
    const std::vector<std::string> names = clip_names(folder);
    if (std::find(names.begin(), names.end(), clip) == names.end())
      throw Error(ErrorKind::kNotFound, clip, "there is no such clip");
    return encoded(first_frame(folder / own_clip_path(clip)));
  }
  const std::shared_ptr<OpenedStore> store = stores_.at(easel->project().state().document.store);
  if (!store) throw Error(ErrorKind::kNotFound, clip, "no store is chosen");
  return encoded(first_frame(store->snapshot(), clip));
}

std::string Ways::open_frame(const cv::Mat& frame, const std::string& name, const std::string& store) {
  const IncomingFile picture = folder_.incoming_file();
  write_whole_file(picture.path(), encoded_png(frame));
  return projects_.open_picture(picture.path(), project_name(name) + ".png", store);
}

std::string Ways::open_clip(const fs::path& file, const std::string& name, bool endless) {
  if (!media::looks_like_video(name))
    throw Error(ErrorKind::kInput, name, "its ending names no video", "Give MP4, MOV, MKV, AVI or WebM");
  cv::Mat frame;
  try {
    frame = first_frame(file);
  } catch (const Error&) {
    throw Error(ErrorKind::kInput, name, "it is no video that can be read",
                "Give MP4, MOV, MKV, AVI or WebM");
  }
  const std::string id = open_frame(frame, name, {});
  if (!endless) return id;
  const std::shared_ptr<Easel> easel = projects_.easel(id);  // it is ours while others are opened
  Project::State state = easel->project().state();
  state.document.flowlines.clip = add_clip(id, file, name);
  state.document.flowlines.dropped = true;
  easel->project().save(state.document, state.version);
  return id;
}

std::string Ways::open_stored_clip(const std::string& store, std::size_t clip, bool as_stills) {
  const std::shared_ptr<OpenedStore> opened = stores_.get(store);
  const store::Snapshot snapshot = opened->snapshot();
  const std::span<const store::ClipId> clips = snapshot.clips();
  if (clip >= clips.size()) throw Error(ErrorKind::kNotFound, "clip", "there is no such clip");
  const std::string name = snapshot.clip(clips[clip]).name, path = opened->path().string();
  if (!as_stills) {
    const std::string id = open_frame(first_frame(snapshot, name), name, path);
    const std::shared_ptr<Easel> easel = projects_.easel(id);
    Project::State state = easel->project().state();
    if (!state.document.flowlines.clip.empty()) return id;
    state.document.flowlines.clip = name;
    easel->project().save(state.document, state.version);
    return id;
  }
  const std::vector<cv::Mat> frames = spread_frames(snapshot, name, kStillsOfAClip);
  const std::string id = open_frame(frames.at(0), fs::path(name).stem().string() + " stills", path);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const IncomingFile file = folder_.incoming_file();
    write_whole_file(file.path(), encoded_png(frames[i]));
    add_still(id, file.path(), fmt::format("{:02}.png", i + 1));
  }
  return id;
}

}  // namespace freshet::studio
