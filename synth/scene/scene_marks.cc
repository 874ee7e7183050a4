#include "synth/scene/scene_marks.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "hints/svg_strokes.h"
#include "platform/text.h"
#include "platform/text_file.h"

namespace freshet::synth::scene {
namespace {

constexpr std::size_t kMaxBytes = 128u << 20;
constexpr double kShortest = 1;  // px
constexpr float kThere = 0.02f;  // alpha
constexpr double kSoftShare =
    0.01;  // of the longer side: an edge that was found on a matte of black and white

/// As names are compared: without case and separators.
std::string plain(const std::string& name) {
  std::string text = lower_case(name);
  std::erase_if(text, [](char c) { return c == ' ' || c == '-' || c == '_'; });
  return text;
}

/// Whether a drawing program's name means the layer: as it is, or with a number behind it.
bool means(const std::string& name, const std::string& layer) {
  const std::string given = plain(name), wanted = plain(layer);
  if (!given.starts_with(wanted)) return false;
  return std::all_of(given.begin() + static_cast<std::ptrdiff_t>(wanted.size()), given.end(),
                     [](char c) { return c >= '0' && c <= '9'; });
}

/// A name that is a layer's own goes before one that has a number behind.
const SceneLayer* named(const Scene& scene, const std::string& name) {
  for (const SceneLayer& layer : scene.layers)
    if (plain(layer.name) == plain(name)) return &layer;
  for (const SceneLayer& layer : scene.layers)
    if (means(name, layer.name)) return &layer;
  return nullptr;
}

const SceneLayer* layer_of(const Scene& scene, const hints::Stroke& stroke) {
  if (!stroke.layer.empty()) {
    for (const SceneLayer& layer : scene.layers)
      if (layer.name == stroke.layer) return &layer;
    throw Error(ErrorKind::kInput, scene.marks.string(),
                fmt::format("{}: its data-layer \"{}\" is no layer of the scene", stroke.name,
                            stroke.layer.substr(0, 60)),
                "Name a layer of the scene");
  }
  for (auto name = stroke.names.rbegin(); name != stroke.names.rend(); ++name)
    if (const SceneLayer* layer = named(scene, *name)) return layer;
  return nullptr;
}

std::vector<hints::Stroke> drawn(const Scene& scene, cv::Size picture, std::vector<std::string>* notices) {
  if (scene.marks.empty()) return {};
  const std::string text = read_text_file(scene.marks, kMaxBytes, "Give the drawing as SVG");
  return hints::read_svg_strokes(text, scene.marks.string(), picture, notices);
}

/// Whether the layer's motion needs the line, which it is given then.
bool take(SceneLayer& layer, const Line& line) {
  const auto first = [&](std::optional<Line>& own) {
    if (own) return false;
    own = line;
    return true;
  };
  if (auto* tree = layer.as<TreeMotion>()) return tree->armatures.push_back(line), true;
  if (auto* water = layer.as<WaterMotion>()) return first(water->horizon);
  if (auto* boat = layer.as<BoatMotion>()) return first(boat->hull);
  return layer.as<PatchesMotion>() != nullptr;  // strokes_of gives them
}

void need(const Scene& scene, const SceneLayer& layer, bool there, const char* what, const char* key) {
  if (there) return;
  throw Error(ErrorKind::kInput, scene.file.string(), fmt::format("layer {}: it has no {}", layer.name, what),
              fmt::format("Draw it in an SVG (marks) in a group called {}, or give {} = [x, y, x, y]",
                          layer.name, key));
}

void check_length(const Scene& scene, const SceneLayer& layer, const Line& line, const char* what) {
  const cv::Point2d way = line.to - line.from;
  if (std::hypot(way.x, way.y) >= kShortest) return;
  throw Error(ErrorKind::kInput, scene.file.string(),
              fmt::format("layer {}: its {} at ({:.0f}, {:.0f}) has no length", layer.name, what, line.from.x,
                          line.from.y),
              "Draw it from one end to the other");
}

/// Whether something of the layer is within `near` px.
bool is_near(cv::Point at, const cv::Mat& alpha, int near) {
  if (alpha.at<float>(at) > kThere) return true;
  const cv::Rect square =
      cv::Rect(at.x - near, at.y - near, 2 * near + 1, 2 * near + 1) & cv::Rect({}, alpha.size());
  for (int y = square.y; y < square.br().y; ++y) {
    const auto* row = alpha.ptr<float>(y);
    const int wide = cvFloor(std::sqrt(static_cast<double>(near * near - (y - at.y) * (y - at.y))));
    const int first = std::max(square.x, at.x - wide), last = std::min(square.br().x, at.x + wide + 1);
    if (std::any_of(row + first, row + last, [](float a) { return a > kThere; })) return true;
  }
  return false;
}

/// Of points on the part of the line that lies in the picture, how many have something of the layer within `near` px.
double part_on(const Line& line, const cv::Mat& alpha, int near) {
  int inside = 0, on = 0;
  constexpr int kPoints = 64;
  for (int i = 0; i < kPoints; ++i) {
    const cv::Point2d p = line.from + (line.to - line.from) * ((i + 0.5) / kPoints);
    const cv::Point at(static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)));
    if (!cv::Rect({0, 0}, alpha.size()).contains(at)) continue;
    ++inside;
    if (is_near(at, alpha, near)) ++on;
  }
  return inside == 0 ? 0 : static_cast<double>(on) / inside;
}

}  // namespace

void read_marks(Scene& scene, cv::Size picture, std::vector<std::string>* notices) {
  for (const hints::Stroke& stroke : drawn(scene, picture, notices)) {
    const SceneLayer* found = layer_of(scene, stroke);
    bool used = found != nullptr;
    if (found != nullptr) {
      SceneLayer& layer = scene.layers[static_cast<std::size_t>(found - scene.layers.data())];
      used = take(layer, {cv::Point2d(stroke.points.front()), cv::Point2d(stroke.points.back())});
    }
    if (used || notices == nullptr) continue;
    notices->push_back(
        found == nullptr
            ? fmt::format("{}: {} names no layer, and is left out; put it into a group called as its layer",
                          scene.marks.string(), stroke.name)
            : fmt::format("{}: {} is left out, {} ({}) needs no further line", scene.marks.string(),
                          stroke.name, found->name, found->kind()));
  }
  for (const SceneLayer& layer : scene.layers) {
    if (const auto* tree = layer.as<TreeMotion>()) {
      need(scene, layer, !tree->armatures.empty(), "armature, from root to tip", "armature");
      for (const Line& line : tree->armatures) check_length(scene, layer, line, "armature");
    }
    if (const auto* water = layer.as<WaterMotion>()) {
      need(scene, layer, water->horizon.has_value(), "horizon", "horizon");
      check_length(scene, layer, *water->horizon, "horizon");
      if (std::abs(water->horizon->to.x - water->horizon->from.x) < kShortest)
        throw Error(ErrorKind::kInput, scene.file.string(),
                    fmt::format("layer {}: its horizon stands upright", layer.name),
                    "Draw it from left to right");
    }
    if (const auto* boat = layer.as<BoatMotion>()) {
      if (boat->reflection_of.empty())
        need(scene, layer, boat->hull.has_value(), "hull line, along the waterline", "hull");
      if (boat->hull) check_length(scene, layer, *boat->hull, "hull line");
    }
  }
}

std::vector<hints::Stroke> strokes_of(const Scene& scene, const SceneLayer& layer, cv::Size picture) {
  std::vector<hints::Stroke> own;
  for (hints::Stroke& stroke : drawn(scene, picture, nullptr))
    if (const SceneLayer* of = layer_of(scene, stroke); of != nullptr && of->name == layer.name)
      own.push_back(std::move(stroke));
  return own;
}

void check_marks(const Scene& scene, const SceneLayer& layer, const cv::Mat& alpha,
                 std::vector<std::string>* notices) {
  const auto fail = [&](const std::string& fault, const std::string& remedy) {
    throw Error(ErrorKind::kInput, scene.file.string(), fmt::format("layer {}: {}", layer.name, fault),
                remedy);
  };
  const cv::Rect box = cv::boundingRect(cv::Mat(alpha > kThere));
  if (box.empty()) {
    if (layer.as<StillMotion>() != nullptr) return;
    fail("nothing of it is to be seen", "Look at its matte, and at those of nearer layers, with --draw");
  }
  const int near = std::max(3, std::max(alpha.cols, alpha.rows) / 50);
  if (const auto* tree = layer.as<TreeMotion>())
    for (const Line& line : tree->armatures)
      if (part_on(line, alpha, near) < 0.5)
        fail(fmt::format("its armature from ({:.0f}, {:.0f}) to ({:.0f}, {:.0f}) lies outside of it",
                         line.from.x, line.from.y, line.to.x, line.to.y),
             fmt::format("It is seen in x {} to {}, y {} to {}: draw the line there, from root to tip", box.x,
                         box.br().x, box.y, box.br().y));
  if (const auto* boat = layer.as<BoatMotion>();
      boat != nullptr && boat->hull && part_on(*boat->hull, alpha, 2 * near) < 0.5)
    fail("its hull line lies outside of it", "Draw it along the waterline, from bow to stern");
  const auto* water = layer.as<WaterMotion>();
  if (water == nullptr) return;
  const Line& horizon = *water->horizon;
  double above = 0, clearly_above = 0, all = 0;
  const double soft = kSoftShare * std::max(alpha.cols, alpha.rows);
  int highest = alpha.rows;
  for (int y = box.y; y < box.br().y; ++y) {
    const auto* row = alpha.ptr<float>(y);
    for (int x = box.x; x < box.br().x; ++x) {
      all += row[x];
      const double at = horizon.from.y + (horizon.to.y - horizon.from.y) * (x + 0.5 - horizon.from.x) /
                                             (horizon.to.x - horizon.from.x);
      if (y + 0.5 < at) above += row[x];
      if (y + 0.5 + soft < at) clearly_above += row[x];
      if (row[x] > 0.5f) highest = std::min(highest, y);
    }
  }
  if (above > 0.1 * all)
    fail(fmt::format("its horizon lies below {:.0f} % of its water, which reaches up to row {}",
                     100 * above / all, highest),
         "Draw the horizon where the plane of the water would end, at or above its far shore");
  if (clearly_above > 0.005 * all && notices != nullptr)
    notices->push_back(
        fmt::format("{}: layer {}: {:.1f} % of its water lies above its horizon and stays still",
                    scene.file.string(), layer.name, 100 * clearly_above / all));
}

}  // namespace freshet::synth::scene
