#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"
#include "studio/http/routes.h"
#include "studio/incoming_file.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

/// What a page may add to an export: names that `synth animate` knows, and values without surprises.
std::vector<std::string> export_options(const Json& json) {
  static const std::vector<std::pair<std::string, std::string>> kKnown{
      {"layer", "abcdefghijklmnopqrstuvwxyz"},
      {"preset", "abcdefghijklmnopqrstuvwxyz"},
      {"depth", "abcdefghijklmnopqrstuvwxyz0123456789"},
      {"range", "0123456789-"},
      {"width", "0123456789"},
      {"start-number", "0123456789"}};
  std::vector<std::string> options;
  for (const auto& [name, letters] : kKnown) {
    const std::string value = word_of(json, name.c_str());
    if (value.empty()) continue;
    if (value.find_first_not_of(letters) != std::string::npos)
      throw Error(ErrorKind::kUsage, name, "\"" + value + "\" is none of its values");
    options.push_back("--" + name + "=" + value);
  }
  return options;
}

void export_animation(Studio& studio, Call& call) {
  const Json asked = call.object();
  const std::string &id = call.value("id"), name = word_of(asked, "name");
  const std::vector<std::string> options = export_options(asked);
  const JobId job = studio.ways().export_animation(id, name, options);
  const std::shared_ptr<Easel> easel =
      studio.projects().easel(id);  // it is ours while other projects are opened
  const Project& project = easel->project();
  call.answer(Json{{"job", job},
                   {"folder", project.folder().string()},
                   {"command", work::to_text(Ways::export_command("freshet", project, name, options))}}
                  .dump());
}

void send_export(Studio& studio, Call& call) {
  const std::string& name = call.value("name");
  call.answer_file(studio.projects().easel(call.value("id"))->project().open_export(name),
                   "application/octet-stream");
  call.response().set_header("Content-Disposition", "attachment; filename=\"" + name + "\"");
}

void save_document(Studio& studio, Call& call) {
  const Projects::Saved saved = studio.projects().save(
      call.value("id"), call.text(), call.number_parameter("base"), call.parameter("page").substr(0, 64));
  call.answer(saved.json);
  if (!saved.taken) call.response().status = 409;
}

void send_picture(Studio& studio, Call& call) {
  constexpr int kFarthest = 1 << 20, kLongest = 4096;  // px
  const auto asked = [&](const char* name, int low, int other, int high) {
    if (call.parameter(name).empty()) return other;
    const std::uint64_t number = std::min<std::uint64_t>(call.number_parameter(name), 1u << 30);
    return std::clamp(static_cast<int>(number), low, high);
  };
  const cv::Rect part(asked("x", 0, 0, kFarthest), asked("y", 0, 0, kFarthest),
                      asked("width", 0, 0, kFarthest), asked("height", 0, 0, kFarthest));
  call.answer(
      studio.projects().easel(call.value("id"))->picture_jpeg(part, asked("longest", 16, 2048, kLongest)),
      "image/jpeg");
}

void send_matte(Studio& studio, Call& call) {
  const std::shared_ptr<Easel> easel = studio.projects().easel(call.value("id"));
  const std::shared_ptr<const FoundMatte> matte = easel->matte();
  if (!matte || matte->number != call.number("number"))
    throw Error(ErrorKind::kNotFound, "matte", "it is no longer there");
  call.answer_for_good(easel->matte_png(call.value("which") == "held" ? matte->held : matte->alpha, 2048),
                       "image/png");
}

/// A frame of a reel, or its outlines.
void send_reel(Studio& studio, Call& call) {
  const std::shared_ptr<const FrameReel> reel =
      studio.projects().easel(call.value("id"))->reel(call.number("number"));
  if (!reel) throw Error(ErrorKind::kNotFound, "reel", "it is not there");
  if (call.value("frame") == "outlines") return call.answer(reel->outlines_json());
  const std::optional<std::string> frame =
      reel->frame(static_cast<int>(std::min<std::uint64_t>(call.number("frame"), 1u << 30)));
  if (!frame) throw Error(ErrorKind::kNotFound, "frame", "it is not there");
  call.answer_for_good(*frame, "image/jpeg");
}

/// A take's strip by its place, or the map of what is worst.
void send_take(Studio& studio, Call& call) {
  const std::shared_ptr<const FoundTakes> takes = studio.projects().easel(call.value("id"))->takes();
  if (!takes || takes->number != call.number("number"))
    throw Error(ErrorKind::kNotFound, "takes", "they are no longer there");
  const bool worst = call.value("which") == "worst";
  const std::size_t take = worst ? 0 : call.number("which");
  const std::string bytes = worst ? takes->worst : take < takes->strips.size() ? takes->strips[take] : "";
  if (bytes.empty()) throw Error(ErrorKind::kNotFound, call.value("which"), "there is no such take");
  call.answer_for_good(bytes, worst ? "image/png" : "image/jpeg");
}

std::shared_ptr<const LabelledPicture> labelled(Studio& studio, const Call& call) {
  std::shared_ptr<const LabelledPicture> labelled = studio.projects().easel(call.value("id"))->labelled();
  if (!labelled) throw Error(ErrorKind::kNotFound, call.value("id"), "nothing has been chosen for it yet");
  return labelled;
}

}  // namespace

std::vector<Route> project_routes(Studio& studio) {
  const auto easel = [&studio](const Call& call) { return studio.projects().easel(call.value("id")); };
  return {
      {"GET", "api/home", kNoBody, [&](Call& call) { call.answer(studio.home_json()); }},
      {"POST", "api/projects", kPictureBody,
       [&](Call& call) {
         const IncomingFile file = studio.folder().incoming_file();
         call.receive(file.path());
         call.answer(
             Json{{"id", studio.projects().open_picture(file.path(), call.parameter("name"))}}.dump());
       }},
      {"POST", "api/clips", kClipBody,
       [&](Call& call) {
         const IncomingFile file = studio.folder().incoming_file();
         call.receive(file.path());
         const bool picture = call.parameter("as") == "picture";
         call.answer(
             Json{{"id", studio.ways().open_clip(file.path(), call.parameter("name"), !picture)}}.dump());
       }},
      {"GET", "api/projects/:id", kNoBody,
       [&](Call& call) { call.answer(studio.projects().to_json(call.value("id"))); }},
      {"DELETE", "api/projects/:id", kNoBody,
       [&](Call& call) {
         studio.projects().remove(call.value("id"));
         call.answer("{}");
       }},
      {"POST", "api/projects/:id/name", kTextBody,
       [&](Call& call) {
         const std::string name = word_of(call.object(), "name");
         call.answer(Json{{"id", studio.projects().rename(call.value("id"), name)}}.dump());
       }},
      {"POST", "api/projects/:id/copies", kTextBody,
       [&](Call& call) {
         const bool reduces = !call.parameter("longest").empty();
         const std::uint64_t longest =
             reduces ? std::clamp<std::uint64_t>(call.number_parameter("longest"), 16, 1u << 20) : 0;
         call.answer(
             Json{{"id", studio.projects().duplicate(call.value("id"), static_cast<int>(longest))}}.dump());
       }},
      {"PUT", "api/projects/:id/document", kTextBody, [&](Call& call) { save_document(studio, call); }},
      {"GET", "api/projects/:id/history", kNoBody,
       [easel](Call& call) { call.answer(easel(call)->project().history()); }},
      {"PUT", "api/projects/:id/history", kTextBody,
       [easel](Call& call) {
         easel(call)->project().write_history(call.text());
         call.answer("{}");
       }},
      {"POST", "api/projects/:id/matte", kPictureBody,
       [&](Call& call) {
         const IncomingFile file = studio.folder().incoming_file();
         call.receive(file.path());
         studio.projects().give_matte(call.value("id"), file.path(), call.parameter("name"));
         call.answer("{}");
       }},
      {"GET", "api/projects/:id/thumbnail", kNoBody,
       [&](Call& call) { call.answer(studio.projects().thumbnail_of(call.value("id")), "image/jpeg"); }},
      {"GET", "api/projects/:id/picture", kNoBody, [&](Call& call) { send_picture(studio, call); }},
      {"GET", "api/projects/:id/field", kNoBody,
       [easel](Call& call) { call.answer(easel(call)->field_json()); }},
      {"GET", "api/projects/:id/made", kNoBody,
       [easel](Call& call) { call.answer(easel(call)->overview_json()); }},
      {"GET", "api/projects/:id/standing", kNoBody,
       [easel](Call& call) { call.answer(easel(call)->standing_json()); }},
      {"POST", "api/projects/:id/standing", kTextBody,
       [easel](Call& call) { call.answer(easel(call)->lying_json(call.object())); }},
      {"GET", "api/projects/:id/mattes/:number/:which", kNoBody,
       [&](Call& call) { send_matte(studio, call); }},
      {"GET", "api/projects/:id/reels/:number/:frame", kNoBody, [&](Call& call) { send_reel(studio, call); }},
      {"GET", "api/projects/:id/pieces", kNoBody,
       [&](Call& call) { call.answer(pieces_json(*labelled(studio, call))); }},
      {"GET", "api/projects/:id/pieces/:piece", kNoBody,
       [&](Call& call) { call.answer(candidates_json(*labelled(studio, call), call.number("piece"))); }},
      {"GET", "api/projects/:id/pieces/:piece/:candidate", kNoBody,
       [&](Call& call) {
         call.answer(candidate_strip(*labelled(studio, call), call.number("piece"), call.number("candidate")),
                     "image/jpeg");
       }},
      {"GET", "api/projects/:id/takes", kNoBody,
       [easel](Call& call) {
         const std::shared_ptr<const FoundTakes> takes = easel(call)->takes();
         call.answer(takes ? takes->json : "null");
       }},
      {"POST", "api/projects/:id/takes", kTextBody,
       [&](Call& call) {
         call.answer(Json{{"job", studio.projects().find_takes(call.value("id"))}}.dump());
       }},
      {"GET", "api/projects/:id/takes/:number/:which", kNoBody, [&](Call& call) { send_take(studio, call); }},
      {"GET", "api/projects/:id/credits", kNoBody,
       [&](Call& call) { call.answer(credits(*labelled(studio, call)), "text/plain; charset=utf-8"); }},
      {"GET", "api/projects/:id/exports", kNoBody,
       [&](Call& call) { call.answer(studio.ways().exports_json(call.value("id"))); }},
      {"POST", "api/projects/:id/exports", kTextBody, [&](Call& call) { export_animation(studio, call); }},
      {"GET", "api/projects/:id/exports/:name", kNoBody, [&](Call& call) { send_export(studio, call); }},
  };
}

}  // namespace freshet::studio
