#include <filesystem>
#include <string>
#include <system_error>

#include "freshet/error.h"
#include "studio/http/routes.h"
#include "studio/incoming_file.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kStripWidth = 240;  // px

void take_clip(Studio& studio, Call& call) {
  const IncomingFile file = studio.folder().incoming_file();
  const fs::path path =
      studio.stores().clip_path(call.value("id"), call.parameter("class"), call.parameter("name"));
  call.receive(file.path());
  std::error_code fault;
  fs::rename(file.path(), path, fault);
  if (fault) throw Error(ErrorKind::kIo, path.string(), "cannot be written");
  call.answer("{}");
}

}  // namespace

std::vector<Route> store_routes(Studio& studio) {
  return {
      {"POST", "api/stores", kTextBody,
       [&](Call& call) {
         call.answer(Json{{"id", studio.stores().create(word_of(call.object(), "name"))}}.dump());
       }},
      {"POST", "api/stores/file", kStoreBody,
       [&](Call& call) {
         const IncomingFile file = studio.folder().incoming_file();
         call.receive(file.path());
         call.answer(Json{{"id", studio.stores().take(file.path(), call.parameter("name"))}}.dump());
       }},
      {"GET", "api/stores/:id", kNoBody,
       [&](Call& call) { call.answer(studio.stores().get(call.value("id"))->to_json()); }},
      {"GET", "api/stores/:id/clips/:clip", kNoBody,
       [&](Call& call) {
         call.answer_for_good(studio.stores().get(call.value("id"))->strip(call.number("clip"), kStripWidth),
                              "image/jpeg");
       }},
      {"POST", "api/stores/:id/clips/:clip/projects", kTextBody,
       [&](Call& call) {
         call.answer(Json{{"id", studio.ways().open_stored_clip(call.value("id"), call.number("clip"),
                                                                call.parameter("as") == "stills")}}
                         .dump());
       }},
      {"POST", "api/stores/:id/clips", kClipBody, [&](Call& call) { take_clip(studio, call); }},
      {"POST", "api/stores/:id/ingest", kTextBody,
       [&](Call& call) {
         const std::string licence = word_of(call.object(), "licence").substr(0, 500);
         call.answer(Json{{"job", studio.stores().ingest(call.value("id"), licence)}}.dump());
       }},
      {"GET", "api/screened/:number", kNoBody,
       [&](Call& call) {
         call.answer_for_good(studio.stores().screened_strip(call.number("number")), "image/jpeg");
       }},
  };
}

}  // namespace freshet::studio
