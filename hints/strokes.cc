#include "hints/strokes.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "hints/svg_strokes.h"
#include "platform/text_file.h"

namespace freshet::hints {
namespace {

using Json = nlohmann::json;

constexpr const char* kFormat = "freshet-strokes";
constexpr int kVersion = 1;
constexpr std::uintmax_t kMaxSvgBytes = 128u << 20, kMaxJsonBytes = 16u << 20;
constexpr std::size_t kDeepest = 32;
constexpr std::size_t kMaxStrokes = 10000, kMaxPoints = 1u << 20, kMostSpeeds = 100;
constexpr double kMaxSpeed = 1e5, kFurthest = 1e7, kShortest = 0.5;
constexpr const char* kJsonRemedy =
    R"(Expected: {"format": "freshet-strokes", "version": 1, "strokes": [{"points": [[x, y], ...]}]})";

std::string read_text(const std::filesystem::path& path) {
  std::error_code fault;
  if (!std::filesystem::exists(path, fault))
    throw Error(ErrorKind::kInput, path.string(), "there is no such file", "Check the name");
  if (!std::filesystem::is_regular_file(path, fault))
    throw Error(ErrorKind::kInput, path.string(), "it is no file", "Name a file of strokes, JSON or SVG");
  const std::uintmax_t size = std::filesystem::file_size(path, fault);
  if (fault || size > kMaxSvgBytes)
    throw Error(ErrorKind::kInput, path.string(),
                fmt::format("it has {} bytes, at most {} expected", size, kMaxSvgBytes),
                "Link the picture in the drawing, do not embed it");
  std::ifstream file(path, std::ios::binary);
  std::string text(size, '\0');
  if (!file.read(text.data(), static_cast<std::streamsize>(size)))
    throw Error(ErrorKind::kInput, path.string(), "it cannot be read", "Check its permissions");
  return text;
}

float read_coordinate(const Json& value, const std::string& where, const std::string& name) {
  const double number = value.is_number() ? value.get<double>() : NAN;
  if (!(std::abs(number) <= kFurthest))
    throw Error(ErrorKind::kInput, where, name + ": a point is two numbers of px", kJsonRemedy);
  return static_cast<float>(number);
}

std::vector<Stroke> read_json(const std::string& text, const std::string& where) {
  const auto fail = [&](const std::string& fault) {
    throw Error(ErrorKind::kInput, where, fault, kJsonRemedy);
  };
  expect_nesting(json_nesting(text), kDeepest, where, kJsonRemedy);
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::exception& fault) {
    fail(std::string("not a JSON file (") + fault.what() + ")");
  }
  if (!json.is_object()) fail("an object expected");
  if (!json.contains("format") || json["format"] != kFormat)
    fail(fmt::format("\"format\" is not \"{}\"", kFormat));
  if (!json.contains("version") || json["version"] != kVersion)
    fail(fmt::format("\"version\" is not {}", kVersion));
  if (!json.contains("strokes") || !json["strokes"].is_array()) fail("\"strokes\" is not a list");
  std::vector<Stroke> strokes;
  std::size_t points = 0;
  for (const Json& entry : json["strokes"]) {
    Stroke stroke;
    stroke.name = fmt::format("stroke {}", strokes.size() + 1);
    if (!entry.is_object() || !entry.contains("points") || !entry["points"].is_array())
      fail(stroke.name + ": \"points\" is not a list");
    if (entry.contains("name") && entry["name"].is_string())
      stroke.name += " \"" + entry["name"].get<std::string>().substr(0, 60) + "\"";
    if ((points += entry["points"].size()) > kMaxPoints) fail("more than a million points");
    for (const Json& point : entry["points"]) {
      if (!point.is_array() || point.size() != 2) fail(stroke.name + ": a point is two numbers of px");
      const float x = read_coordinate(point[0], where, stroke.name);
      stroke.points.emplace_back(x, read_coordinate(point[1], where, stroke.name));
    }
    if (entry.contains("speed") && !entry["speed"].is_null()) {
      const Json& said = entry["speed"];
      const Json speeds = said.is_array() ? said : Json::array({said});
      if (speeds.empty() || speeds.size() > kMostSpeeds)
        fail(fmt::format("{}: \"speed\" has {} numbers, 1 to {} expected", stroke.name, speeds.size(),
                         kMostSpeeds));
      for (const Json& speed : speeds) {
        if (!speed.is_number()) fail(stroke.name + ": \"speed\" is not a number of px/s");
        stroke.speeds.push_back(static_cast<float>(speed.get<double>()));
      }
      stroke.speed_px_per_s = stroke.speeds.front();
      if (stroke.speeds.size() < 2) stroke.speeds.clear();
    }
    strokes.push_back(std::move(stroke));
    if (strokes.size() > kMaxStrokes) break;
  }
  return strokes;
}

double length_of(const Stroke& stroke) {
  double length = 0;
  for (std::size_t i = 1; i < stroke.points.size(); ++i)
    length += cv::norm(stroke.points[i] - stroke.points[i - 1]);
  return length;
}

// Whether a segment has a point inside the picture: its part between the picture's four lines is not empty.
bool crosses(cv::Point2f a, cv::Point2f b, cv::Size picture) {
  double from = 0, to = 1;
  const auto cut = [&](double start, double way, double high) {
    if (way == 0) return start >= 0 && start <= high;
    const double first = -start / way, second = (high - start) / way;
    from = std::max(from, std::min(first, second));
    to = std::min(to, std::max(first, second));
    return from <= to;
  };
  return cut(a.x, b.x - a.x, picture.width) && cut(a.y, b.y - a.y, picture.height);
}

void check(const std::vector<Stroke>& strokes, const std::string& where, cv::Size picture) {
  const auto fail = [&](const std::string& fault, const std::string& remedy) {
    throw Error(ErrorKind::kInput, where, fault, remedy);
  };
  if (strokes.empty()) fail("no stroke in it", "Draw at least one line, in the direction of the flow");
  if (strokes.size() > kMaxStrokes)
    fail(fmt::format("more than {} strokes", kMaxStrokes), "Draw fewer: a dozen do");
  for (const Stroke& stroke : strokes) {
    if (!(length_of(stroke) >= kShortest)) {
      const std::string place =
          stroke.points.empty() ? "without any point"
                                : fmt::format("at ({:.0f}, {:.0f})", stroke.points[0].x, stroke.points[0].y);
      fail(fmt::format("{} {} has no length, and so no direction", stroke.name, place),
           "Remove it, or draw it as a line");
    }
    if (stroke.speed_px_per_s && !(*stroke.speed_px_per_s >= 0 && *stroke.speed_px_per_s <= kMaxSpeed))
      fail(fmt::format("{} has a speed of {}, 0 to {} px/s expected", stroke.name, *stroke.speed_px_per_s,
                       kMaxSpeed),
           "Mend its speed");
    for (const float speed : stroke.speeds)
      if (!(speed >= 0 && speed <= kMaxSpeed))
        fail(fmt::format("{} has a speed of {}, 0 to {} px/s expected", stroke.name, speed, kMaxSpeed),
             "Mend its speeds");
    bool inside = false;
    for (std::size_t i = 1; i < stroke.points.size() && !inside; ++i)
      inside = crosses(stroke.points[i - 1], stroke.points[i], picture);
    if (!inside) {
      cv::Point2f low = stroke.points[0], high = low;
      for (const cv::Point2f& point : stroke.points) {
        low = {std::min(low.x, point.x), std::min(low.y, point.y)};
        high = {std::max(high.x, point.x), std::max(high.y, point.y)};
      }
      fail(fmt::format("{} lies outside the picture: x {:.0f} to {:.0f}, y {:.0f} to {:.0f}, and the picture "
                       "has {} x {} px",
                       stroke.name, low.x, high.x, low.y, high.y, picture.width, picture.height),
           "Draw it over the picture, or remove it");
    }
  }
}

}  // namespace

std::optional<float> speed_at(const Stroke& stroke, double share) {
  if (stroke.speeds.size() < 2) return stroke.speed_px_per_s;
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(stroke.speeds.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), stroke.speeds.size() - 2);
  const auto part = static_cast<float>(at - static_cast<double>(i));
  return stroke.speeds[i] * (1 - part) + stroke.speeds[i + 1] * part;
}

std::vector<Stroke> read_strokes(const std::filesystem::path& path, cv::Size picture,
                                 std::vector<std::string>* notices) {
  const std::string text = read_text(path), where = path.string();
  if (text.starts_with("\x1f\x8b"))
    throw Error(ErrorKind::kInput, where, "it is compressed", "Save it as plain SVG");
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  // UTF-16 begins with its mark; pugixml knows it.
  const bool svg = first != std::string::npos &&
                   (text[first] == '<' || text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"));
  if (!svg && text.size() > kMaxJsonBytes)
    throw Error(ErrorKind::kInput, where,
                fmt::format("it has {} bytes, at most {} of JSON expected", text.size(), kMaxJsonBytes),
                "Draw fewer and simpler strokes");
  if (!svg && (first == std::string::npos || (text[first] != '{' && text[first] != '[')))
    throw Error(ErrorKind::kInput, where, "neither JSON nor SVG",
                "Save the strokes as plain SVG, or write JSON");
  std::vector<Stroke> strokes =
      svg ? read_svg_strokes(text, where, picture, notices) : read_json(text, where);
  check(strokes, where, picture);
  return strokes;
}

}  // namespace freshet::hints
