#include <algorithm>
#include <cstdint>
#include <string>

#include "studio/http/routes.h"
#include "studio/incoming_file.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

const char* type_of(const std::string& name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".svg")) return "image/svg+xml";
  return name.ends_with(".mp4") ? "video/mp4" : "image/png";
}

}  // namespace

std::vector<Route> way_routes(Studio& studio) {
  const auto film = [&studio](Call& call) {
    call.answer_file(studio.ways().film(call.value("id"), call.value("way")), "video/mp4");
  };
  return {
      {"GET", "api/projects/:id/ways/:way", kNoBody,
       [&](Call& call) { call.answer(studio.ways().to_json(call.value("id"), call.value("way"))); }},
      {"POST", "api/projects/:id/ways/:way", kTextBody,
       [&](Call& call) {
         call.answer(Json{{"job", studio.ways().run(call.value("id"), call.value("way"))}}.dump());
       }},
      {"POST", "api/projects/:id/ways/:way/exports", kTextBody,
       [&](Call& call) {
         const Json asked = call.object();
         call.answer(studio.ways().export_film(call.value("id"), call.value("way"), word_of(asked, "name"),
                                               asked.value("alone", Json()) == true));
       }},
      {"GET", "api/projects/:id/ways/:way/film", kNoBody, film},
      {"GET", "api/projects/:id/ways/:way/files/film.mp4", kNoBody, film},  // as the way's own page calls it
      {"GET", "api/projects/:id/ways/:way/files/:name", kNoBody,
       [&](Call& call) {
         const std::string& name = call.value("name");
         call.answer_file(studio.ways().file(call.value("id"), call.value("way"), name), type_of(name));
       }},
      {"POST", "api/projects/:id/layers", kTextBody,
       [&](Call& call) {
         const auto first =
             static_cast<int>(std::min<std::uint64_t>(call.number_parameter("from"), 1u << 20));
         call.answer(Json{{"job", studio.projects().show_layers(call.value("id"), first)}}.dump());
       }},
      {"GET", "api/projects/:id/layers/:layer/matte", kNoBody,
       [&](Call& call) {
         call.answer(studio.ways().layer_matte_png(call.value("id"), call.number("layer")), "image/png");
       }},
      {"GET", "api/projects/:id/stills", kNoBody,
       [&](Call& call) { call.answer(studio.ways().stills_json(call.value("id"))); }},
      {"GET", "api/projects/:id/stills/:name", kNoBody,
       [&](Call& call) {
         const std::string &id = call.value("id"), &name = call.value("name");
         const bool whole = call.parameter("whole") == "1";
         call.answer(whole ? studio.ways().still_jpeg(id, name) : studio.ways().still_thumbnail(id, name),
                     "image/jpeg");
       }},
      {"POST", "api/projects/:id/stills", kPictureBody,
       [&](Call& call) {
         const IncomingFile file = studio.folder().incoming_file();
         call.receive(file.path());
         studio.ways().add_still(call.value("id"), file.path(), call.parameter("name"));
         call.answer("{}");
       }},
      {"DELETE", "api/projects/:id/stills", kNoBody,
       [&](Call& call) {
         studio.ways().remove_stills(call.value("id"));
         call.answer("{}");
       }},
      {"GET", "api/projects/:id/clips", kNoBody,
       [&](Call& call) { call.answer(studio.ways().clips_json(call.value("id"))); }},
      {"GET", "api/projects/:id/clips/frame", kNoBody,
       [&](Call& call) {
         call.answer(
             studio.ways().clip_frame(call.value("id"), call.parameter("clip"), call.parameter("own") == "1"),
             "image/jpeg");
       }},
      {"POST", "api/projects/:id/clips", kClipBody,
       [&](Call& call) {
         const IncomingFile file = studio.folder().incoming_file();
         call.receive(file.path());
         call.answer(
             Json{{"name", studio.ways().add_clip(call.value("id"), file.path(), call.parameter("name"))}}
                 .dump());
       }},
  };
}

}  // namespace freshet::studio
