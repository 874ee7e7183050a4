// synth/simulate/design/scene_file.cc
#include "synth/simulate/design/scene_file.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "platform/text_file.h"
#include "synth/simulate/design/shape.h"

namespace freshet::synth::simulate {
namespace {

constexpr std::size_t kMaxSceneBytes = 4u << 20, kDeepest = 32;
constexpr const char* kSceneRemedy =
    "Give a TOML file; freshet synth simulate --print-scene plume prints one";

namespace fs = std::filesystem;

constexpr int kMaxRows = 2048, kMinRows = 16, kMaxSteps = 32;
constexpr std::size_t kMaxThings = 64, kMaxKnots = 10000;
constexpr double kFar = 1e6;

struct Range {
  double low, high;
};

std::string kind_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::string:
      return "the text \"" + node.ref<std::string>() + "\"";
    case toml::node_type::integer:
      return fmt::format("{}", node.ref<std::int64_t>());
    case toml::node_type::floating_point:
      return fmt::format("{}", node.ref<double>());
    case toml::node_type::boolean:
      return node.ref<bool>() ? "true" : "false";
    default:
      return "a date";
  }
}

/// One table of the file. Keys are asked for by name; done() refuses those that nobody asked for.
class Section {
 public:
  Section(const fs::path& file, const toml::table& table, std::string name)
      : file_(file), table_(table), name_(std::move(name)) {}

  [[noreturn]] void refuse(const toml::node& at, const std::string& key, const std::string& fault,
                           const std::string& remedy = {}) const {
    throw Error(ErrorKind::kInput, fmt::format("{}:{}", file_.string(), at.source().begin.line),
                (name_.empty() ? key
                 : key.empty() ? name_
                               : name_ + "." + key) +
                    ": " + fault,
                remedy);
  }
  [[noreturn]] void refuse_whole(const std::string& fault, const std::string& remedy = {}) const {
    refuse(table_, "", fault, remedy);
  }

  const toml::node* find(const std::string& key) {
    known_.push_back(key);
    return table_.get(key);
  }

  double number(const toml::node& node, const std::string& key, Range range) const {
    const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value) refuse(node, key, fmt::format("a number is expected, not {}", kind_of(node)));
    if (!(*value >= range.low && *value <= range.high))
      refuse(node, key, fmt::format("{} is out of range", *value),
             fmt::format("Give {} to {}", range.low, range.high));
    return *value;
  }

  template <typename T>
  void read(const std::string& key, T& value, Range range) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    if (std::is_integral_v<T> && !node->is_integer())
      refuse(*node, key, fmt::format("a whole number is expected, not {}", kind_of(*node)));
    value = static_cast<T>(number(*node, key, range));
  }

  std::optional<std::string> text(const std::string& key) {
    const toml::node* node = find(key);
    if (node == nullptr) return std::nullopt;
    if (!node->is_string())
      refuse(*node, key, fmt::format("text in quotes is expected, not {}", kind_of(*node)));
    return node->ref<std::string>();
  }

  /// One of several words; its place among them.
  std::optional<std::size_t> word(const std::string& key, const std::vector<std::string>& words) {
    const std::optional<std::string> given = text(key);
    if (!given) return std::nullopt;
    const auto at = std::find(words.begin(), words.end(), *given);
    if (at == words.end())
      refuse(*table_.get(key), key, fmt::format("\"{}\" is not known", *given),
             fmt::format("Choose one of {}", fmt::join(words, ", ")));
    return static_cast<std::size_t>(at - words.begin());
  }

  bool flag(const std::string& key, bool otherwise) {
    const toml::node* node = find(key);
    if (node == nullptr) return otherwise;
    if (!node->is_boolean())
      refuse(*node, key, fmt::format("true or false is expected, not {}", kind_of(*node)));
    return node->ref<bool>();
  }

  std::vector<double> numbers(const toml::node& node, const std::string& key, std::size_t count,
                              Range range) const {
    const toml::array* list = node.as_array();
    if (list == nullptr || list->size() != count)
      refuse(node, key,
             fmt::format("a list of {} numbers is expected, not {}", count,
                         list != nullptr ? fmt::format("one of {}", list->size()) : kind_of(node)));
    std::vector<double> values;
    for (const toml::node& each : *list) values.push_back(number(each, key, range));
    return values;
  }
  Vec2 pair(const toml::node& node, const std::string& key, Range range) const {
    const std::vector<double> values = numbers(node, key, 2, range);
    return {static_cast<float>(values[0]), static_cast<float>(values[1])};
  }
  bool read(const std::string& key, Vec2& value, Range range) {
    const toml::node* node = find(key);
    if (node != nullptr) value = pair(*node, key, range);
    return node != nullptr;
  }
  void read(const std::string& key, Rgb& value) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const std::vector<double> v = numbers(*node, key, 3, {0.0, 4.0});
    value = {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
  }

  /// A list of lists, each of a time and `width` values; times must grow.
  std::vector<std::vector<double>> knots(const toml::node& node, const std::string& key, std::size_t width,
                                         Range range) const {
    const toml::array* list = node.as_array();
    if (list == nullptr || list->empty() || list->size() > kMaxKnots)
      refuse(node, key,
             fmt::format("a list of 1 to {} lists [second, ...] is expected, not {}", kMaxKnots,
                         list != nullptr ? fmt::format("one of {}", list->size()) : kind_of(node)));
    std::vector<std::vector<double>> result;
    for (const toml::node& each : *list) {
      const toml::array* knot = each.as_array();
      if (knot == nullptr || knot->size() != width + 1)
        refuse(each, key, fmt::format("each knot is a list of {} numbers, the first its second", width + 1));
      std::vector<double> values{number((*knot)[0], key, {-kFar, kFar})};
      for (std::size_t i = 0; i < width; ++i) values.push_back(number((*knot)[i + 1], key, range));
      if (!result.empty() && !(values[0] > result.back()[0]))
        refuse(each, key, fmt::format("second {} does not come after {}", values[0], result.back()[0]));
      result.push_back(std::move(values));
    }
    return result;
  }

  std::optional<Section> table(const std::string& key) {
    const toml::node* node = find(key);
    if (node == nullptr) return std::nullopt;
    if (!node->is_table())
      refuse(*node, key, fmt::format("a table [{}] is expected, not {}", key, kind_of(*node)));
    return Section(file_, *node->as_table(), key);
  }
  std::vector<Section> tables(const std::string& key) {
    std::vector<Section> result;
    const toml::node* node = find(key);
    if (node == nullptr) return result;
    const toml::array* list = node->as_array();
    const auto is_table = [](const toml::node& each) { return each.is_table(); };
    if (list == nullptr || !std::all_of(list->begin(), list->end(), is_table))
      refuse(*node, key, fmt::format("tables are expected, each below [[{}]]", key));
    if (list->size() > kMaxThings)
      refuse(*node, key, fmt::format("there are {}", list->size()),
             fmt::format("{} is the maximum", kMaxThings));
    for (std::size_t i = 0; i < list->size(); ++i)
      result.emplace_back(file_, *(*list)[i].as_table(), fmt::format("{} {}", key, i + 1));
    return result;
  }

  void done() const {
    for (const auto& [key, node] : table_) {
      const std::string name(key.str());
      if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
      refuse(node, name, "no such key", fmt::format("There are {}", fmt::join(known_, ", ")));
    }
  }

  const fs::path& file() const { return file_; }
  void rename(const std::string& name) { name_ += " (" + name + ")"; }

 private:
  const fs::path& file_;
  const toml::table& table_;
  std::string name_;
  std::vector<std::string> known_;
};

void read_span(Section& section, Span& span) {
  section.read("from", span.from_s, {-kFar, kFar});
  section.read("to", span.to_s, {-kFar, kFar});
  if (!(span.to_s > span.from_s))
    section.refuse(*section.find("to"), "to",
                   fmt::format("it ends at {} s, before it begins at {} s", span.to_s, span.from_s));
}

cv::Mat read_mask(Section& section, const std::string& name) {
  fs::path path(name);
  if (path.is_relative()) path = section.file().parent_path() / path;
  cv::Mat bgr;
  try {
    bgr = media::read_picture(path).bgr;
  } catch (const Error& fault) {
    section.refuse(*section.find("picture"), "picture", fault.what());
  }
  cv::Mat grey(bgr.size(), CV_8U);
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      const cv::Vec3b c = bgr.at<cv::Vec3b>(y, x);
      grey.at<std::uint8_t>(y, x) = std::max({c[0], c[1], c[2]});
    }
  }
  return grey;
}

Shape read_shape(Section& section, cv::Size size) {
  static const std::vector<std::string> kNames{"disc", "line", "polygon", "picture"};
  const Range place{-2.0, 3.0}, length{0.0, 2.0};
  Shape shape;
  const std::optional<std::size_t> kind = section.word("shape", kNames);
  if (!kind)
    section.refuse_whole("it has no shape", "Give shape = \"disc\", \"line\", \"polygon\" or \"picture\"");
  shape.kind = static_cast<Shape::Kind>(*kind);
  const auto need = [&](const std::string& key) -> const toml::node& {
    const toml::node* node = section.find(key);
    if (node == nullptr)
      section.refuse_whole(fmt::format("a {} needs {}", kNames[*kind], key),
                           "Places are [fraction of the width, fraction of the height]");
    return *node;
  };
  switch (shape.kind) {
    case Shape::Kind::kDisc:
      shape.points = {section.pair(need("position"), "position", place)};
      section.read("radius", shape.radius, {1e-3, 2.0});
      break;
    case Shape::Kind::kLine: {
      shape.points = {section.pair(need("start"), "start", place), section.pair(need("end"), "end", place)};
      float width = 0.02f;
      section.read("width", width, {1e-3, 2.0});
      shape.radius = 0.5f * width;
      break;
    }
    case Shape::Kind::kPolygon: {
      const toml::node& corners = need("corners");
      const toml::array* list = corners.as_array();
      if (list == nullptr || list->size() < 3 || list->size() > kMaxKnots)
        section.refuse(corners, "corners", "a list of at least three places [x, y] is expected");
      for (const toml::node& corner : *list) shape.points.push_back(section.pair(corner, "corners", place));
      break;
    }
    case Shape::Kind::kPicture: {
      const toml::node& name = need("picture");
      if (!name.is_string()) section.refuse(name, "picture", "the name of a picture is expected");
      shape.picture = read_mask(section, name.ref<std::string>());
      break;
    }
  }
  section.read("softness", shape.softness, length);
  if (const toml::node* move = section.find("move"); move != nullptr) {
    for (const std::vector<double>& knot : section.knots(*move, "move", 2, {-5.0, 5.0}))
      shape.move.push_back(
          {static_cast<float>(knot[0]), Vec2{static_cast<float>(knot[1]), static_cast<float>(knot[2])}});
  }
  // Of a moving shape the start may lie outside: it comes in.
  Grid coverage(std::clamp(size.width / 2, 1, 512), std::clamp(size.height / 2, 1, 512));
  if (shape.move.empty() && draw_shape(shape, {}, coverage).empty())
    section.refuse_whole("it lies outside the picture",
                         "Places are fractions: [0, 0] is the upper left corner, [1, 1] the lower right one");
  return shape;
}

Emitter read_emitter(Section& section, cv::Size size) {
  Emitter emitter;
  if (const auto name = section.text("name")) emitter.name = *name, section.rename(*name);
  emitter.shape = read_shape(section, size);
  read_span(section, emitter.span);
  const Range densities{0.0, 100.0};
  if (const toml::node* rate = section.find("rate"); rate != nullptr) {
    if (rate->is_array()) {
      emitter.rate.clear();
      for (const std::vector<double>& knot : section.knots(*rate, "rate", 1, densities))
        emitter.rate.emplace_back(static_cast<float>(knot[0]), static_cast<float>(knot[1]));
    } else {
      emitter.rate = {{0.0f, static_cast<float>(section.number(*rate, "rate", densities))}};
    }
  }
  section.read("velocity", emitter.velocity, {-20.0, 20.0});
  section.read("heat", emitter.heat, {0.0, 100.0});
  section.read("expansion", emitter.expansion, {0.0, 100.0});
  section.read("jitter", emitter.jitter, {0.0, 1.0});
  section.read("lump", emitter.lump, {1e-3, 2.0});
  section.done();
  return emitter;
}

Obstacle read_obstacle(Section& section, cv::Size size) {
  Obstacle obstacle;
  if (const auto name = section.text("name")) obstacle.name = *name, section.rename(*name);
  obstacle.shape = read_shape(section, size);
  read_span(section, obstacle.span);
  section.done();
  return obstacle;
}

Force read_force(Section& section) {
  Force force;
  const auto kind = section.word("kind", {"wind", "point", "vortex", "turbulence"});
  if (!kind)
    section.refuse_whole("it has no kind", "Give kind = \"wind\", \"point\", \"vortex\" or \"turbulence\"");
  force.kind = static_cast<Force::Kind>(*kind);
  read_span(section, force.span);
  section.read("strength", force.strength, {-100.0, 100.0});
  switch (force.kind) {
    case Force::Kind::kWind:
      if (!section.read("velocity", force.velocity, {-20.0, 20.0}))
        section.refuse_whole("a wind needs a velocity", "Give velocity = [right, down], heights per second");
      break;
    case Force::Kind::kPoint:
    case Force::Kind::kVortex:
      if (!section.read("position", force.position, {-2.0, 3.0}))
        section.refuse_whole("it needs a position",
                             "Give position = [fraction of the width, fraction of the height]");
      section.read("radius", force.radius, {1e-2, 10.0});
      break;
    case Force::Kind::kTurbulence:
      section.read("size", force.size, {5e-3, 2.0});
      section.read("change", force.change, {0.0, 100.0});
      force.in_fluid_only = !section.flag("everywhere", false);
      break;
  }
  section.done();
  return force;
}

void read_fluid(Section& section, FluidOptions& fluid) {
  section.read("buoyancy", fluid.buoyancy, {-100.0, 100.0});
  section.read("gravity", fluid.gravity, {-100.0, 100.0});
  section.read("weight", fluid.weight, {1.0, 100.0});
  section.read("vorticity", fluid.vorticity, {0.0, 20.0});
  section.read("dissipation", fluid.dissipation, {0.0, 20.0});
  section.read("burning", fluid.burning, {0.0, 20.0});
  section.read("cooling", fluid.cooling, {0.0, 20.0});
  section.read("viscosity", fluid.viscosity, {0.0, 0.01});
  section.read("drag", fluid.drag, {0.0, 20.0});
  section.read("still_air", fluid.still_air, {0.0, 20.0});
  section.read("top_speed", fluid.top_speed, {0.0, 20.0});
  section.done();
}

void read_sides(Section& section, Design& design) {
  const auto side = [&](const char* name, Side& value) {
    if (const auto word = section.word(name, {"open", "closed"}))
      value = *word == 0 ? Side::kOpen : Side::kClosed;
  };
  side("left", design.left), side("right", design.right), side("top", design.top);
  side("bottom", design.bottom);
  section.done();
}

void read_look(Section& section, Look& look) {
  section.read("opacity", look.opacity, {0.01, 100.0});
  section.read("thin", look.thin);
  section.read("dense", look.dense);
  section.read("glow", look.glow, {0.0, 1.0});
  section.done();
}

SceneOptions read_file(Section& file) {
  SceneOptions scene;
  Design& design = scene.design;
  Vec2 size{640.0f, 360.0f};
  file.read("size", size, {16.0, 4096.0});
  scene.size = {static_cast<int>(size.x), static_cast<int>(size.y)};
  file.read("frames", scene.frames, {1.0, 1e6});
  file.read("fps", scene.fps, {1.0, 240.0});
  std::int64_t seed = 1;
  file.read("seed", seed, {0.0, 9e15});
  scene.seed = static_cast<std::uint64_t>(seed);
  std::vector<std::string> clips;
  for (const SceneKind kind : all_clip_kinds()) clips.emplace_back(scene_kind_name(kind));
  if (const auto clip = file.word("clip", clips)) {
    scene.kind = all_clip_kinds()[*clip];
    file.done();
    return scene;
  }
  scene.kind = SceneKind::kDesign;
  file.read("warm_up", design.warm_up_s, {0.0, 600.0});
  file.read("grid", design.rows, {kMinRows, kMaxRows});
  file.read("steps", design.steps, {1.0, kMaxSteps});
  if (auto section = file.table("fluid")) read_fluid(*section, design.fluid);
  if (auto section = file.table("sides")) read_sides(*section, design);
  if (auto section = file.table("look")) read_look(*section, design.look);
  for (Section& section : file.tables("emitter"))
    design.emitters.push_back(read_emitter(section, scene.size));
  for (Section& section : file.tables("obstacle"))
    design.obstacles.push_back(read_obstacle(section, scene.size));
  for (Section& section : file.tables("force")) design.forces.push_back(read_force(section));
  file.done();
  if (design.emitters.empty())
    file.refuse_whole("no emitter: nothing would be seen", "Add a table [[emitter]]; --keys explains it");
  return scene;
}

}  // namespace

bool names_scene_file(const std::filesystem::path& scene) { return scene.extension() == ".toml"; }

SceneOptions named_scene(const std::filesystem::path& scene) {
  return names_scene_file(scene) ? read_scene(scene) : parse_scene(preset_scene(scene.string()), scene);
}

SceneOptions parse_scene(std::string_view text, const fs::path& name) {
  expect_nesting(toml_nesting(text), kDeepest, name.string(), kSceneRemedy);
  toml::table table;
  try {
    table = toml::parse(text);
  } catch (const toml::parse_error& fault) {
    throw Error(ErrorKind::kInput, fmt::format("{}:{}", name.string(), fault.source().begin.line),
                fmt::format("it is not TOML: {}", fault.description()));
  }
  Section file(name, table, "");
  return read_file(file);
}

std::string scene_text(const fs::path& path) { return read_text_file(path, kMaxSceneBytes, kSceneRemedy); }

SceneOptions read_scene(const fs::path& path) { return parse_scene(scene_text(path), path); }

}  // namespace freshet::synth::simulate
