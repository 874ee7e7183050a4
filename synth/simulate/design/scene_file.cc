// synth/simulate/design/scene_file.cc
#include "synth/simulate/design/scene_file.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "synth/simulate/design/shape.h"
#include "synth/toml/keys.h"

namespace freshet::synth::simulate {
namespace {

constexpr const char* kSceneRemedy =
    "Give a TOML file; freshet synth simulate --print-scene plume prints one";

// clang-format off
constexpr const char* kKeys =
#include "embedded/scene_keys.txt"
    ;
// clang-format on

namespace fs = std::filesystem;

constexpr int kMaxRows = 2048, kMinRows = 16, kMaxSteps = 32;
constexpr std::size_t kMaxCorners = 10000;
constexpr double kFar = 1e6;

void read_span(Section& section, Span& span) {
  section.read("from", span.from_s, {-kFar, kFar});
  section.read("to", span.to_s, {-kFar, kFar});
  if (!(span.to_s > span.from_s))
    section.refuse(*section.find("to"), "to",
                   fmt::format("it ends at {} s, before it begins at {} s", span.to_s, span.from_s));
}

cv::Mat read_mask(Section& section, const std::string& name) {
  const fs::path path = section.beside(name);
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
      if (list == nullptr || list->size() < 3 || list->size() > kMaxCorners)
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

const std::vector<Key<FluidOptions>>& fluid_keys() {
  static const std::vector<Key<FluidOptions>> keys{
      {"buoyancy", &FluidOptions::buoyancy, {-100, 100}, "heights/s^2", "upwards for heat 1"},
      {"gravity", &FluidOptions::gravity, {-100, 100}, "heights/s^2", "downwards for density 1"},
      {"weight",
       &FluidOptions::weight,
       {1, 100},
       "",
       "times heavier than the air: falls and shoots on as water does"},
      {"top_speed",
       &FluidOptions::top_speed,
       {0, 20},
       "heights/s",
       "speed at which drag holds against buoyancy and gravity; 0: none"},
      {"vorticity", &FluidOptions::vorticity, {0, 20}, "1/s", "vorticity confinement: curls"},
      {"dissipation", &FluidOptions::dissipation, {0, 20}, "1/s", "fraction of the density lost per second"},
      {"burning",
       &FluidOptions::burning,
       {0, 20},
       "1/s",
       "density lost per second, whatever there is: tongues"},
      {"cooling", &FluidOptions::cooling, {0, 20}, "1/s", "fraction of the heat lost per second"},
      {"viscosity", &FluidOptions::viscosity, {0, 0.01}, "heights^2/s", "viscosity"},
      {"drag", &FluidOptions::drag, {0, 20}, "1/s", "fraction of the velocity lost per second"},
      {"still_air", &FluidOptions::still_air, {0, 20}, "1/s", "the same where there is no fluid"}};
  return keys;
}

const std::vector<Key<ClipVariation>>& clip_keys() {
  static const std::vector<Key<ClipVariation>> keys{
      {"speed", &ClipVariation::speed, {0.1, 10}, "", "of all motion"},
      {"zoom", &ClipVariation::zoom, {0.2, 5}, "", "size of all forms; speeds in px grow with it"},
      {"amount", &ClipVariation::amount, {0.1, 10}, "", "how much fluid, foam or cover there is"}};
  return keys;
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

void read_frames(Section& section, SceneOptions& scene) {
  Vec2 size{static_cast<float>(scene.size.width), static_cast<float>(scene.size.height)};
  section.read("size", size, {16.0, 4096.0});
  scene.size = {static_cast<int>(size.x), static_cast<int>(size.y)};
  section.read("frames", scene.frames, {1.0, 1e6});
  section.read("fps", scene.fps, {1.0, 240.0});
  std::int64_t seed = static_cast<std::int64_t>(scene.seed);
  section.read("seed", seed, {0.0, 9e15});
  scene.seed = static_cast<std::uint64_t>(seed);
}

/// False where the table names no clip.
bool read_clip_keys(Section& section, SceneOptions& scene) {
  std::vector<std::string> clips;
  for (const SceneKind kind : all_clip_kinds()) clips.emplace_back(scene_kind_name(kind));
  const auto clip = section.word("clip", clips);
  if (!clip) return false;
  scene.kind = all_clip_kinds()[*clip];
  read_keys(section, clip_keys(), scene.variation, "");
  return true;
}

SceneOptions read_file(Section& file) {
  SceneOptions scene;
  Design& design = scene.design;
  read_frames(file, scene);
  if (read_clip_keys(file, scene)) {
    file.done();
    return scene;
  }
  scene.kind = SceneKind::kDesign;
  file.read("warm_up", design.warm_up_s, {0.0, 600.0});
  file.read("grid", design.rows, {kMinRows, kMaxRows});
  file.read("steps", design.steps, {1.0, kMaxSteps});
  if (auto section = file.table("fluid")) {
    read_keys(*section, fluid_keys(), design.fluid, "");
    section->done();
  }
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

SceneOptions read_clip(Section& table, const SceneOptions& usual) {
  SceneOptions scene = usual;
  read_frames(table, scene);
  if (!read_clip_keys(table, scene))
    table.refuse_whole("it names no clip", "Give clip = \"fire\", or another of the ready-made ones");
  table.done();
  return scene;
}

std::string scene_keys() {
  std::string text = kKeys;
  const auto fill = [&](std::string_view place, const std::string& lines) {
    text.replace(text.find(place), place.size(), lines);
  };
  fill("{clip}\n", key_lines(key_texts(clip_keys())));
  fill("{fluid}\n", key_lines(key_texts(fluid_keys())));
  return text;
}

bool names_scene_file(const std::filesystem::path& scene) { return scene.extension() == ".toml"; }

SceneOptions named_scene(const std::filesystem::path& scene) {
  return names_scene_file(scene) ? read_scene(scene) : parse_scene(preset_scene(scene.string()), scene);
}

SceneOptions parse_scene(std::string_view text, const fs::path& name) {
  const TomlText parsed(text, name, kSceneRemedy);
  Section file = parsed.root();
  return read_file(file);
}

std::string scene_text(const fs::path& path) { return toml_file_text(path, kSceneRemedy); }

SceneOptions read_scene(const fs::path& path) { return parse_scene(scene_text(path), path); }

}  // namespace freshet::synth::simulate
