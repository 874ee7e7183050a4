#include "studio/drawing/stills.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "studio/drawing/fields.h"

namespace freshet::studio {

using Json = nlohmann::json;

namespace {

constexpr std::size_t kMaxNames = 10000, kMaxPins = 1000;

/// Of files and regions.
std::string full_name(const Fields& fields, const char* name) {
  std::string text = fields.text(name);
  if (text.empty()) fields.fail(fmt::format("\"{}\" is no name", name));
  return text;
}

std::vector<StillsPath> read_stills_paths(const Fields& stills) {
  std::vector<StillsPath> paths;
  for (const Json& item : stills.list("paths", kMaxNames)) {
    const Fields fields = stills.below(item, "paths", paths.size());
    fields.only({"region", "names", "refused"});
    paths.push_back({.region = full_name(fields, "region"), .names = {}, .refused = fields.flag("refused")});
    for (const Json& name : fields.list("names", kMaxNames)) {
      const Json holder{{"names", name}};
      paths.back().names.push_back(full_name(fields.below(holder, "names", 0), "names"));
    }
    if (paths.back().names.size() < 2) fields.fail("a path has two stills or more");
  }
  return paths;
}

std::vector<StillsPin> read_stills_pins(const Fields& stills) {
  std::vector<StillsPin> pins;
  if (!stills.has("pins")) return pins;  // of a document that is older than them
  for (const Json& item : stills.list("pins", kMaxPins)) {
    const Fields fields = stills.below(item, "pins", pins.size());
    fields.only({"from", "to", "points", "reach"});
    const std::vector<cv::Point2f> points = fields.points();
    if (points.size() != 2) fields.fail("its \"points\" are not two");
    pins.push_back({.from = full_name(fields, "from"),
                    .to = full_name(fields, "to"),
                    .at = points[0],
                    .goes = points[1],
                    .reach = fields.number("reach", 1, 100000)});
  }
  return pins;
}

}  // namespace

Stills read_stills(const Fields& fields) {
  fields.only({"seconds", "speed", "loop", "split", "full", "paths", "pins"});
  return {.seconds = fields.number("seconds", 0.4, 120),
          .speed = fields.number("speed", 0.05, 20),
          .loop = fields.flag("loop"),
          .split = fields.integer("split", 1, 8),
          .full = fields.flag("full"),
          .paths = read_stills_paths(fields),
          .pins = read_stills_pins(fields)};
}

Json stills_json(const Stills& stills) {
  Json json{{"seconds", stills.seconds}, {"speed", stills.speed}, {"loop", stills.loop},
            {"split", stills.split},     {"full", stills.full},   {"paths", Json::array()},
            {"pins", Json::array()}};
  for (const StillsPath& path : stills.paths)
    json["paths"].push_back({{"region", path.region}, {"names", path.names}, {"refused", path.refused}});
  for (const StillsPin& pin : stills.pins)
    json["pins"].push_back({{"from", pin.from},
                            {"to", pin.to},
                            {"points", points_json({pin.at, pin.goes})},
                            {"reach", pin.reach}});
  return json;
}

}  // namespace freshet::studio
