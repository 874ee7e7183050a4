#include "studio/drawing/document.h"

#include <algorithm>
#include <functional>
#include <set>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "platform/text_file.h"
#include "studio/drawing/direction_brush.h"
#include "studio/drawing/fields.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxBytes = 16u << 20, kDeepest = 16, kMaxNames = 10000;

const char* to_string(MatteBase base) {
  switch (base) {
    case MatteBase::kAlpha:
      return "alpha";
    case MatteBase::kWhole:
      return "whole";
    case MatteBase::kFile:
      return "file";
    case MatteBase::kScribbles:
      break;
  }
  return "scribbles";
}

std::vector<Drawn> read_directions(const Fields& fields) {
  if (!fields.has("directions")) return {};  // of a document that is older than it
  return fields.drawn("directions");
}

std::vector<DrawnTempo> read_tempo(const Fields& fields) {
  std::vector<DrawnTempo> tempo;
  if (!fields.has("tempo")) return tempo;  // of a document that is older than it
  for (const Json& item : fields.list("tempo", kMaxLines)) {
    const Fields line = fields.below(item, "tempo", tempo.size());
    line.only({"points", "width", "factor"});
    tempo.push_back({.points = line.points(),
                     .width = static_cast<float>(line.number("width", 0, kWidest)),
                     .factor = static_cast<float>(line.number("factor", 0.5, 2))});
  }
  return tempo;
}

std::vector<Pin> read_pins(const Fields& fields) {
  std::vector<Pin> pins;
  for (const Json& item : fields.list("pins", kMaxLines)) {
    const Fields pin = fields.below(item, "pins", pins.size());
    pin.only({"x", "y", "clip", "variant", "patch_x", "patch_y"});
    constexpr int kFar = 1 << 20;
    pins.push_back({.corner = {pin.integer("x", -kFar, kFar), pin.integer("y", -kFar, kFar)},
                    .clip = pin.text("clip"),
                    .variant = pin.integer("variant", 0, 255),
                    .patch = {pin.integer("patch_x", 0, kFar), pin.integer("patch_y", 0, kFar)}});
  }
  return pins;
}

void read_option(const Fields& fields, const char* name, bool& option) { option = fields.flag(name); }
void read_option(const Fields& fields, const char* name, double& option, double low, double high) {
  option = fields.number(name, low, high);
}
void read_option(const Fields& fields, const char* name, std::string& option,
                 const std::vector<std::string>& words) {
  option = fields.word(name, words);
}

MatteBase read_base(const Fields& fields) {
  const std::string name = fields.text("matte_base");
  for (const MatteBase base : {MatteBase::kScribbles, MatteBase::kAlpha, MatteBase::kWhole, MatteBase::kFile})
    if (name == to_string(base)) return base;
  fields.fail("\"matte_base\" is none of scribbles, alpha, whole, file");
}

Json matte_json(const Document& document) {
  return {{"matte_base", to_string(document.matte_base)},
          {"edge", document.edge},
          {"scribbles", drawn_json(document.scribbles)},
          {"paint", drawn_json(document.paint)},
          {"held", drawn_json(document.held)}};
}

Json labels_json(const Document& document) {
  Json json = matte_json(document);
  json["store"] = document.store;
  json["class"] = document.class_name;
  json["excluded_clips"] = document.excluded_clips;
  json["frames"] = document.frames;
  json["fps"] = document.fps;
  json["strokes"] = strokes_json(document.strokes);
  json["horizon"] = document.horizon;
  json["directions"] = drawn_json(document.directions);
  json["pins"] = Json::array();
  for (const Pin& pin : document.pins)
    json["pins"].push_back({{"x", pin.corner.x},
                            {"y", pin.corner.y},
                            {"clip", pin.clip},
                            {"variant", pin.variant},
                            {"patch_x", pin.patch.x},
                            {"patch_y", pin.patch.y}});
  return json;
}

Json frames_json(const Document& document) {
  Json json = labels_json(document);
  each_option([&](const char* name, auto field, const auto&...) { json[name] = document.*field; });
  json["tempo"] = Json::array();
  for (const DrawnTempo& line : document.tempo)
    json["tempo"].push_back(
        {{"points", points_json(line.points)}, {"width", line.width}, {"factor", line.factor}});
  return json;
}

std::uint64_t hash_of(const Json& json) { return std::hash<std::string>()(json.dump()); }

}  // namespace

std::string to_json(const Document& document) {
  Json json = frames_json(document);
  each_way([&](const char* name, auto field, auto, auto write) { json[name] = write(document.*field); });
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Document document_from_json(std::string_view json, const std::string& where) {
  const auto refuse = [&](const std::string& fault) {
    throw Error(ErrorKind::kInput, where, fault, "Reload the page");
  };
  if (json.size() > kMaxBytes) refuse("it has more than 16 MB");
  expect_nesting(json_nesting(json), kDeepest, where, "Reload the page");
  Json parsed;
  try {
    parsed = Json::parse(json);
  } catch (const Json::exception& fault) {
    refuse(fmt::format("it is no JSON ({})", fault.what()));
  }
  std::size_t points = 0;
  const Fields fields(parsed, where, points);
  std::set<std::string> names{"matte_base", "edge",       "scribbles",      "paint",  "held",
                              "store",      "class",      "excluded_clips", "frames", "fps",
                              "strokes",    "directions", "tempo",          "pins"};
  each_option([&](const char* name, auto, const auto&...) { names.insert(name); });
  each_way([&](const char* name, auto, auto, auto) { names.insert(name); });
  fields.only(names);
  Document document{.store = fields.text("store"),
                    .matte_base = read_base(fields),
                    .edge = fields.text("edge"),
                    .scribbles = fields.drawn("scribbles"),
                    .paint = fields.drawn("paint"),
                    .held = fields.drawn("held"),
                    .strokes = fields.strokes("strokes"),
                    .directions = read_directions(fields),
                    .tempo = read_tempo(fields),
                    .class_name = fields.text("class"),
                    .excluded_clips = {},
                    .pins = read_pins(fields),
                    .frames = fields.integer("frames", 1, 2000),
                    .fps = fields.number("fps", 1, 240)};
  each_option([&](const char* name, auto field, const auto&... allowed) {
    if (fields.has(name)) read_option(fields, name, document.*field, allowed...);
  });
  if (document.speed != 0 && document.speed < 0.05) fields.fail("\"speed\" is neither 0 nor from 0.05 to 20");
  each_way([&](const char* name, auto field, auto read, auto) {
    if (fields.has(name)) document.*field = read(fields.below(fields.at(name), name, 0));
  });
  if (document.edge != "guided" && document.edge != "information-flow" && document.edge != "none")
    fields.fail("\"edge\" is none of guided, information-flow, none");
  for (const Json& name : fields.list("excluded_clips", kMaxNames)) {
    const Json holder{{"name", name}};
    document.excluded_clips.push_back(Fields(holder, where, points).text("name"));
  }
  return document;
}

std::vector<DrawnStroke> flow_strokes(const Document& document, cv::Size picture) {
  std::vector<DrawnStroke> strokes = document.strokes;
  std::vector<DrawnStroke> brushed = brush_strokes(document.directions, picture);
  strokes.insert(strokes.end(), brushed.begin(), brushed.end());
  return strokes;
}

std::string strokes_svg(const Document& document, cv::Size picture) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n",
      picture.width, picture.height);
  for (const DrawnStroke& stroke : flow_strokes(document, picture)) {
    svg += "  <polyline fill=\"none\" stroke=\"#fff\" stroke-width=\"2\"";
    if (stroke.speed) svg += fmt::format(" data-speed=\"{:g}\"", *stroke.speed);
    svg += " points=\"";
    for (std::size_t i = 0; i < stroke.points.size(); ++i)
      svg += fmt::format("{}{:.2f},{:.2f}", i == 0 ? "" : " ", stroke.points[i].x, stroke.points[i].y);
    svg += "\"/>\n";
  }
  return svg + "</svg>\n";
}

std::string marks_json(const Document& document) {
  Json marks = Json::array();
  for (const Drawn& line : document.scribbles)
    marks.push_back({{"is", line.adds ? "fluid" : "background"},
                     {"points", points_json(line.points)},
                     {"width", line.width}});
  return Json{{"format", "freshet-marks"}, {"version", 1}, {"marks", marks}}.dump() + "\n";
}

std::uint64_t matte_key(const Document& document) { return hash_of(matte_json(document)); }
std::uint64_t labels_key(const Document& document) { return hash_of(labels_json(document)); }
std::uint64_t frames_key(const Document& document) { return hash_of(frames_json(document)); }

}  // namespace freshet::studio
