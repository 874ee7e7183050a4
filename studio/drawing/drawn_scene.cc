#include "studio/drawing/drawn_scene.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "studio/drawing/fields.h"
#include "synth/scene/scene.h"
#include "synth/scene/scene_file.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostLayers = 64, kLongestName = 60;

constexpr const char* kFilms[] = {"design", "flowlines", "stills", "clip"};
constexpr const char* kMattes[] = {"painted", "scribbled", "rest"};  // by LayerMatte

/// A name that a scene file takes.
std::string layer_name(const Fields& fields) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_- ";
  std::string name = fields.text("name");
  if (name.empty() || name.size() > kLongestName || name.find_first_not_of(kLetters) != std::string::npos)
    fields.fail("\"name\" is no name of a layer: 1 to 60 letters, digits, '-', '_' and spaces");
  return name;
}

/// A number that goes into the scene file as it is. table, key   of the scene (scene_ranges).
double number(const Fields& fields, const char* name, const char* table, const char* key) {
  const synth::Range range = synth::scene::scene_range(table, key).range;
  return fields.number(name, range.low, range.high);
}

std::string read_motion(const Fields& fields) {
  if (fields.text("motion") == "film") return "footage";  // as older documents call it
  std::vector<std::string> names;
  for (const DrawnMotion& motion : kDrawnMotions) names.emplace_back(motion.name);
  return fields.word("motion", names);
}

DrawnLayer read_layer(const Fields& fields) {
  fields.only({"name",       "motion",     "matte",     "paint",        "lines",     "plant", "shimmer",
               "waves",      "mirrors",    "roll",      "drift",        "class",     "film",  "clip",
               "matte_clip", "start",      "repeats",   "ground",       "blend",     "in_3d", "shade",
               "glow",       "glow_reach", "sway_clip", "sway_dropped", "sway_lines"});
  const std::string matte = fields.word("matte", {std::begin(kMattes), std::end(kMattes)});
  DrawnLayer layer{.name = layer_name(fields),
                   .motion = read_motion(fields),
                   .matte = matte == kMattes[0]   ? LayerMatte::kPainted
                            : matte == kMattes[1] ? LayerMatte::kScribbled
                                                  : LayerMatte::kRest,
                   .paint = fields.drawn("paint"),
                   .lines = fields.strokes("lines"),
                   .plant = fields.word("plant", {"tree", "flower", "grass"}),
                   .shimmer = number(fields, "shimmer", "tree", "shimmer"),
                   .waves = number(fields, "waves", "water", "amplitude"),
                   .mirrors = fields.flag("mirrors"),
                   .roll = number(fields, "roll", "boat", "roll"),
                   .drift = number(fields, "drift", "clouds", "speed"),
                   .class_name = fields.text("class")};
  // Older documents have none of these.
  if (fields.has("in_3d")) layer.in_3d = fields.flag("in_3d");
  if (fields.has("glow")) layer.glow = number(fields, "glow", "layer", "glow");
  if (fields.has("glow_reach"))
    layer.glow_reach =
        fields.number("glow_reach", 0, synth::scene::scene_range("layer", "glow_reach").range.high);
  if (fields.has("sway_clip")) layer.sway_clip = fields.text("sway_clip");
  if (fields.has("sway_dropped")) layer.sway_dropped = fields.flag("sway_dropped");
  if (fields.has("sway_lines")) layer.sway_lines = fields.strokes("sway_lines");
  if (fields.has("shade")) layer.shade = number(fields, "shade", "clouds", "shade");
  if (fields.has("clip")) layer.clip = fields.text("clip");
  layer.film = layer.clip.empty() ? kFilms[0] : "clip";
  if (fields.has("film")) layer.film = fields.word("film", {std::begin(kFilms), std::end(kFilms)});
  if (fields.has("matte_clip")) layer.matte_clip = fields.text("matte_clip");
  if (fields.has("start")) layer.start = number(fields, "start", "footage", "start");
  if (fields.has("repeats")) layer.repeats = fields.flag("repeats");
  if (fields.has("ground")) layer.ground = fields.word("ground", media::ground_names());
  if (fields.has("blend"))
    layer.blend = fields.word("blend", {std::begin(media::kBlends), std::end(media::kBlends)});
  const std::string dropped = layer.sway_dropped ? layer.sway_clip : "";
  for (const auto& [key, name] : {std::pair("clip", layer.clip), std::pair("matte_clip", layer.matte_clip),
                                  std::pair("sway_clip", dropped)})
    if (name.find('/') != std::string::npos || name.starts_with('.'))
      fields.fail(fmt::format("\"{}\" is no file of the project", key));
  return layer;
}

Json layer_json(const DrawnLayer& layer) {
  return {{"name", layer.name},
          {"motion", layer.motion},
          {"matte", kMattes[static_cast<int>(layer.matte)]},
          {"paint", drawn_json(layer.paint)},
          {"lines", strokes_json(layer.lines)},
          {"plant", layer.plant},
          {"shimmer", layer.shimmer},
          {"waves", layer.waves},
          {"mirrors", layer.mirrors},
          {"roll", layer.roll},
          {"in_3d", layer.in_3d},
          {"drift", layer.drift},
          {"shade", layer.shade},
          {"class", layer.class_name},
          {"film", layer.film},
          {"clip", layer.clip},
          {"matte_clip", layer.matte_clip},
          {"start", layer.start},
          {"repeats", layer.repeats},
          {"ground", layer.ground},
          {"blend", layer.blend},
          {"glow", layer.glow},
          {"glow_reach", layer.glow_reach},
          {"sway_clip", layer.sway_clip},
          {"sway_dropped", layer.sway_dropped},
          {"sway_lines", strokes_json(layer.sway_lines)}};
}

}  // namespace

const DrawnMotion& drawn_motion(const std::string& name) {
  const auto* const found = std::find_if(std::begin(kDrawnMotions), std::end(kDrawnMotions),
                                         [&](const DrawnMotion& motion) { return name == motion.name; });
  if (found == std::end(kDrawnMotions)) throw Error(ErrorKind::kNotFound, name, "there is no such motion");
  return *found;
}

DrawnScene read_scene(const Fields& fields) {
  fields.only({"wind", "direction", "gustiness", "changes", "becomes", "frames", "loop", "layers"});
  DrawnScene scene{.wind = number(fields, "wind", "wind", "speed"),
                   .direction = number(fields, "direction", "wind", "direction"),
                   .gustiness = number(fields, "gustiness", "wind", "gustiness"),
                   .frames = fields.integer("frames", 1, 2000),
                   .loop = fields.flag("loop"),
                   .layers = {}};
  // Older documents have neither.
  if (fields.has("changes")) scene.changes = fields.flag("changes");
  if (fields.has("becomes")) scene.becomes = number(fields, "becomes", "wind", "speed");
  std::set<std::string> names;
  for (const Json& item : fields.list("layers", kMostLayers)) {
    const Fields layer = fields.below(item, "layers", scene.layers.size());
    scene.layers.push_back(read_layer(layer));
    if (!names.insert(scene.layers.back().name).second) layer.fail("another layer has this \"name\"");
  }
  return scene;
}

Json scene_json(const DrawnScene& scene) {
  Json json{{"wind", scene.wind},       {"direction", scene.direction}, {"gustiness", scene.gustiness},
            {"changes", scene.changes}, {"becomes", scene.becomes},     {"frames", scene.frames},
            {"loop", scene.loop},       {"layers", Json::array()}};
  for (const DrawnLayer& layer : scene.layers) json["layers"].push_back(layer_json(layer));
  return json;
}

}  // namespace freshet::studio
