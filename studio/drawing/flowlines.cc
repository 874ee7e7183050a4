#include "studio/drawing/flowlines.h"

#include <set>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "media/frame/filmed_ground.h"
#include "studio/drawing/fields.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostClipLines = 2000, kMostSpeeds = 64, kMostPositions = 64, kLongestId = 64;

/// One that means nothing to SVG.
std::string line_id(const Fields& fields) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  std::string id = fields.text("id");
  if (id.empty() || id.size() > kLongestId || id.find_first_not_of(kLetters) != std::string::npos)
    fields.fail("\"id\" is no name of a line");
  return id;
}

std::vector<LinePosition> read_positions(const Fields& line) {
  std::vector<LinePosition> later;
  if (!line.has("later")) return later;  // of a document that is older than it
  for (const Json& item : line.list("later", kMostPositions)) {
    const Fields position = line.below(item, "later", later.size());
    position.only({"time", "points"});
    later.push_back({.time = position.number("time", 0.01, 1000), .points = position.points()});
    if (later.back().points.size() < 2) position.fail("a line has two points or more");
    if (later.size() > 1 && later.back().time <= later[later.size() - 2].time)
      position.fail("\"time\" is not after that of the position before");
  }
  return later;
}

std::vector<ClipLine> read_lines(const Fields& fields, const char* name) {
  std::vector<ClipLine> lines;
  std::set<std::string> ids;
  for (const Json& item : fields.list(name, kMostClipLines)) {
    const Fields line = fields.below(item, name, lines.size());
    line.only({"id", "points", "speeds", "later"});
    lines.push_back(
        {.id = line_id(line), .points = line.points(), .speeds = {}, .later = read_positions(line)});
    if (lines.back().points.size() < 2) line.fail("a line has two points or more");
    if (!ids.insert(lines.back().id).second) line.fail("another line has this \"id\"");
    for (const Json& speed : line.list("speeds", kMostSpeeds)) {
      const Json holder{{"speeds", speed}};
      lines.back().speeds.push_back(
          static_cast<float>(line.below(holder, "speeds", 0).number("speeds", 0.05, 20)));
    }
  }
  return lines;
}

Json lines_json(const std::vector<ClipLine>& lines) {
  Json json = Json::array();
  for (const ClipLine& line : lines) {
    Json later = Json::array();
    for (const LinePosition& position : line.later)
      later.push_back({{"time", position.time}, {"points", points_json(position.points)}});
    json.push_back(
        {{"id", line.id}, {"points", points_json(line.points)}, {"speeds", line.speeds}, {"later", later}});
  }
  return json;
}

}  // namespace

Flowlines read_flowlines(const Fields& fields) {
  fields.only({"clip", "dropped", "lines", "edited", "join", "stretched", "ground", "frames", "loop",
               "moving_camera"});
  Flowlines flowlines{.clip = fields.text("clip"),
                      .dropped = fields.flag("dropped"),
                      .lines = read_lines(fields, "lines"),
                      .edited = read_lines(fields, "edited"),
                      .join = fields.number("join", 0, 10000),
                      .stretched = fields.flag("stretched"),
                      .ground = fields.word("ground", media::ground_names()),
                      .frames = fields.integer("frames", 1, 20000),
                      .loop = fields.flag("loop"),
                      .moving_camera = fields.flag("moving_camera")};
  if (flowlines.dropped && (flowlines.clip.find('/') != std::string::npos || flowlines.clip.starts_with('.')))
    fields.fail("\"clip\" is no file of the project");
  for (const ClipLine& line : flowlines.lines)
    if (!line.later.empty()) fields.fail("\"lines\" has one that moves; only \"edited\" ones can");
  if (!flowlines.edited.empty() && flowlines.lines.empty())
    fields.fail("\"edited\" lines are copies of \"lines\", of which there are none");
  return flowlines;
}

Json flowlines_json(const Flowlines& flowlines) {
  return {{"clip", flowlines.clip},
          {"dropped", flowlines.dropped},
          {"lines", lines_json(flowlines.lines)},
          {"edited", lines_json(flowlines.edited)},
          {"join", flowlines.join},
          {"stretched", flowlines.stretched},
          {"ground", flowlines.ground},
          {"frames", flowlines.frames},
          {"loop", flowlines.loop},
          {"moving_camera", flowlines.moving_camera}};
}

std::string own_clip_path(const std::string& clip) { return "ways/flowlines/clips/" + clip; }

std::string clip_lines_svg(const std::vector<ClipLine>& lines) {
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\">\n<g fill=\"none\" stroke=\"#20a0ff\">\n";
  const auto add = [&](const ClipLine& line, const std::vector<cv::Point2f>& points, double time) {
    svg += fmt::format("<polyline id=\"{}\"", line.id);
    if (!line.later.empty()) svg += fmt::format(" data-time=\"{:g}\"", time);
    if (!line.speeds.empty()) svg += fmt::format(" data-speed=\"{:.4g}\"", fmt::join(line.speeds, " "));
    svg += " points=\"";
    for (const cv::Point2f& point : points)
      svg += fmt::format("{}{:.2f},{:.2f}", svg.back() == '"' ? "" : " ", point.x, point.y);
    svg += "\"/>\n";
  };
  for (const ClipLine& line : lines) {
    add(line, line.points, 0);
    for (const LinePosition& position : line.later) add(line, position.points, position.time);
  }
  return svg + "</g>\n</svg>\n";
}

}  // namespace freshet::studio
