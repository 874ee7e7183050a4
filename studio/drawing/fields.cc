#include "studio/drawing/fields.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "freshet/error.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxPoints = 1u << 20, kMaxText = 4096;
constexpr double kMaxSpeed = 1e5;  // px/s

}  // namespace

Fields::Fields(const Json& object, std::string where, std::size_t& points)
    : object_(object), where_(std::move(where)), points_(points) {
  if (!object_.is_object()) fail("an object expected");
}

void Fields::fail(const std::string& fault) const {
  throw Error(ErrorKind::kInput, where_, fault, "Reload the page");
}

void Fields::only(const std::set<std::string>& names) const {
  for (const auto& [name, value] : object_.items())
    if (!names.contains(name)) fail(fmt::format("there is no \"{}\"", name));
}

const Json& Fields::at(const char* name) const {
  const auto found = object_.find(name);
  if (found == object_.end()) fail(fmt::format("\"{}\" is missing", name));
  return *found;
}

double Fields::number(const char* name, double low, double high) const {
  const Json& value = at(name);
  const double found = value.is_number() ? value.get<double>() : NAN;
  if (!(found >= low && found <= high))
    fail(fmt::format("\"{}\" is no number from {} to {}", name, low, high));
  return found;
}

int Fields::integer(const char* name, int low, int high) const {
  const double found = number(name, low, high);
  if (found != std::floor(found)) fail(fmt::format("\"{}\" is no whole number", name));
  return static_cast<int>(found);
}

bool Fields::flag(const char* name) const {
  if (!at(name).is_boolean()) fail(fmt::format("\"{}\" is neither true nor false", name));
  return at(name).get<bool>();
}

std::string Fields::text(const char* name) const {
  const Json& value = at(name);
  if (!value.is_string()) fail(fmt::format("\"{}\" is no text", name));
  const auto& found = value.get_ref<const std::string&>();
  if (found.size() > kMaxText) fail(fmt::format("\"{}\" is longer than {} bytes", name, kMaxText));
  // What cannot stand in a line of a TOML file, or end a C string, is no name of anything.
  for (const char c : found)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      fail(fmt::format("\"{}\" holds a control character", name));
  return found;
}

std::string Fields::word(const char* name, const std::vector<std::string>& words) const {
  std::string found = text(name);
  if (std::find(words.begin(), words.end(), found) == words.end())
    fail(fmt::format("\"{}\" is none of {}", name, fmt::join(words, ", ")));
  return found;
}

const Json& Fields::list(const char* name, std::size_t most) const {
  const Json& value = at(name);
  if (!value.is_array()) fail(fmt::format("\"{}\" is no list", name));
  if (value.size() > most) fail(fmt::format("\"{}\" has more than {} entries", name, most));
  return value;
}

Fields Fields::below(const Json& item, const char* name, std::size_t index) const {
  return {item, fmt::format("{}, {} {}", where_, name, index + 1), points_};
}

std::vector<cv::Point2f> Fields::points() const {
  std::vector<cv::Point2f> points;
  for (const Json& item : list("points", kMaxPoints)) {
    if (!item.is_array() || item.size() != 2 || !item[0].is_number() || !item[1].is_number())
      fail("a point is two numbers of px");
    const double x = item[0].get<double>(), y = item[1].get<double>();
    if (!(std::abs(x) <= kFurthest && std::abs(y) <= kFurthest)) fail("a point lies far outside");
    points.emplace_back(static_cast<float>(x), static_cast<float>(y));
  }
  if (points.empty()) fail("it has no point");
  points_ += points.size();
  if (points_ > kMaxPoints) fail(fmt::format("there are more than {} points", kMaxPoints));
  return points;
}

std::vector<Drawn> Fields::drawn(const char* name) const {
  std::vector<Drawn> lines;
  for (const Json& item : list(name, kMaxLines)) {
    const Fields line = below(item, name, lines.size());
    line.only({"points", "width", "adds", "area"});
    lines.push_back({.points = line.points(),
                     .width = static_cast<float>(line.number("width", 0, kWidest)),
                     .adds = line.flag("adds"),
                     .is_area = line.flag("area")});
  }
  return lines;
}

std::vector<DrawnStroke> Fields::strokes(const char* name) const {
  std::vector<DrawnStroke> strokes;
  for (const Json& item : list(name, kMaxLines)) {
    const Fields stroke = below(item, name, strokes.size());
    stroke.only({"points", "speed"});
    strokes.push_back({.points = stroke.points(), .speed = {}});
    if (stroke.has("speed") && !stroke.at("speed").is_null())
      strokes.back().speed = static_cast<float>(stroke.number("speed", 0, kMaxSpeed));
  }
  return strokes;
}

Json points_json(const std::vector<cv::Point2f>& points) {
  Json json = Json::array();
  for (const cv::Point2f& point : points) json.push_back({point.x, point.y});
  return json;
}

Json drawn_json(const std::vector<Drawn>& lines) {
  Json json = Json::array();
  for (const Drawn& line : lines)
    json.push_back({{"points", points_json(line.points)},
                    {"width", line.width},
                    {"adds", line.adds},
                    {"area", line.is_area}});
  return json;
}

Json strokes_json(const std::vector<DrawnStroke>& strokes) {
  Json json = Json::array();
  for (const DrawnStroke& stroke : strokes)
    json.push_back(
        {{"points", points_json(stroke.points)}, {"speed", stroke.speed ? Json(*stroke.speed) : Json()}});
  return json;
}

}  // namespace freshet::studio
