#include "synth/scene/scene_file.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"
#include "synth/scene/kinds/kind_keys.h"
#include "synth/toml/keys.h"

namespace freshet::synth::scene {
namespace {

constexpr const char* kRemedy =
    "Give a TOML file; freshet synth scene --init PICTURE -o SCENE.toml makes one";
constexpr std::size_t kMaxLayers = 256, kMaxWindKeys = 256;
constexpr const char* kExplained = "freshet synth scene --keys explains it";
/// Rows of the file's top, of [wind] and of what every layer has.
const std::vector<Key<Scene>>& top_keys() {
  static const std::vector<Key<Scene>> keys{
      {"picture", &Scene::picture, {}, "", "the still (PNG, JPEG, TIFF, EXR)", kNeeded},
      {"marks",
       &Scene::marks,
       {},
       "",
       "SVG over it: a line whose group, label, id or data-layer is a layer's name. It is an armature (from "
       "root to tip) "
       "of a tree, the horizon of water, the hull line of a boat, a stroke of patches",
       "none"},
      {"paint",
       &Scene::paint,
       {},
       "",
       "OpenRaster (.ora: Krita, GIMP, MyPaint) with a layer of paint for each layer whose matte is "
       "\"paint\" or "
       "\"painted\"",
       "none"},
      {"cut",
       &Scene::cut,
       {},
       "",
       "OpenRaster that freshet synth layers wrote, maybe painted over: these layers are moved, and none is "
       "cut",
       "none"},
      {"frames", &Scene::frames, {1, 1e5}, "", "number of frames"},
      {"fps", &Scene::fps, {1, 240}, "1/s", "frames per second"},
      {"loop",
       &Scene::loop,
       {},
       "",
       "the last frame runs into the first: all motion has the animation's length as its period"}};
  return keys;
}

const std::vector<Key<Wind>>& wind_keys() {
  static const std::vector<Key<Wind>> keys{
      {"speed", &Wind::speed_m_per_s, {0, 60}, "m/s", "mean speed", {}, Range{0, 20}},
      {"direction",
       &Wind::direction_deg,
       {-360, 360},
       "degrees",
       "where it blows to, seen from above: 0 right, 90 away from the viewer, 180 left",
       {},
       Range{-180, 180}},
      {"turbulence", &Wind::turbulence, {0, 1}, "", "standard deviation of its speed, a share of it"},
      {"kappa",
       &Wind::kappa_m,
       {0.01, 1e5},
       "m",
       "above speed / kappa hertz its spectrum falls with the power -5/3 (Eq. 8)"},
      {"gustiness",
       &Wind::gustiness,
       {0, 1},
       "",
       "share of the turbulence that crosses the picture at the wind's speed: trees bend one after the "
       "other, water "
       "darkens; 0 as in the paper"},
      {"width", &Wind::width_m, {0.1, 1e5}, "m", "width of the picture, for gusts"},
      {"seed", &Wind::seed, {0, 9e15}, "", "another seed, another wind"},
      {"at", {}, {}, "", "[[wind.at]]: weather that changes, as below", "the wind stays as it is"}};
  return keys;
}

const std::vector<Key<WindKey>>& weather_keys() {
  static const std::vector<Key<WindKey>> keys{
      {"time", &WindKey::time_s, {0.001, 1e5}, "s", "when it is so, from the film's beginning", kNeeded},
      {"speed", &WindKey::speed_m_per_s, {0, 60}, "m/s", "mean speed", "as it goes on", Range{0, 20}},
      {"direction",
       &WindKey::direction_deg,
       {-360, 360},
       "degrees",
       "where it blows to; it turns there the short way round",
       "as it goes on",
       Range{-180, 180}},
      {"gustiness",
       &WindKey::gustiness,
       {0, 1},
       "",
       "share of the turbulence that crosses the picture",
       "as it goes on"}};
  return keys;
}

void take_blend(SceneLayer& layer, std::size_t word) { layer.blend = static_cast<Blend>(word); }
void read_name(Section& section, SceneLayer& layer);
void read_motion(Section& section, SceneLayer& layer);
void read_matte(Section& section, SceneLayer& layer);
void read_shadow(Section& section, SceneLayer& layer);

const std::vector<Key<SceneLayer>>& layer_keys() {
  static const std::vector<Key<SceneLayer>> keys{
      {"name", read_name, {}, "", "letters, digits, '-', '_' and spaces", kNeeded},
      {"order", &SceneLayer::order, {1, 1e6}, "", "1 is nearest", "place in the file"},
      {"seed", &SceneLayer::seed, {0, 9e15}, "", "of this layer's own randomness", "place in the file"},
      {"motion", read_motion, {}, "", "still, or one of the kinds below", kNeeded},
      {"blend",
       Words<SceneLayer>{{std::begin(kBlends), std::end(kBlends)}, take_blend},
       {},
       "",
       "what it does to what lies behind it: covers it, adds its light, or adds it and never exceeds white"},
      {"matte",
       read_matte,
       {},
       "",
       "a grey picture, white where the layer is, or one with alpha; \"paint\": where its paint is; "
       "\"painted\": and its "
       "colours are the paint's too; \"rest\": what all others leave. Kinds that bring their own pixels have "
       "none, but for footage",
       "this or one of the next two"},
      {"scribbles", {}, {}, "", "strokes on the layer (white, green) and beside it (black, red)", "none"},
      {"trimap", {}, {}, "", "white the layer, black not, grey unknown", "none"},
      {"shadow",
       read_shadow,
       {},
       "",
       "[x, y, x, y] from where the layer stands to where the shadow of its top falls, on layers behind it. "
       "Layers of water, clouds and those that bring their own pixels cast none",
       "none"},
      {"shadow_darkness",
       &SceneLayer::shadow_darkness,
       {0, 1},
       "",
       "share of the light that its shadow takes"},
      {"shadow_softness",
       &SceneLayer::shadow_softness_px,
       {0, 500},
       "px",
       "deviation by which its shadow is blurred",
       "a 20th of the shadow's length"},
      {"shadow_in_still",
       &SceneLayer::shadow_in_still,
       {},
       "",
       "true: the still shows this shadow, which is divided out where it was; false: it is new"},
      {"glow",
       &SceneLayer::glow,
       {0, 10},
       "",
       "of patches, transfer and footage: how much brighter all layers around it are for each time that its "
       "light exceeds that of its first frame with any, which the still shows; but for clouds, added light "
       "and other fires. Of water: the same of its glints, each about where it glitters; but for glittering "
       "water",
       {},
       Range{0, 1}},
      {"glow_reach",
       &SceneLayer::glow_reach_px,
       {1, kFarPx},
       "px",
       "distance at which half of that is left",
       "a fifth of the picture's longer side; of water .03 of it"}};
  return keys;
}

MatteFrom matte_from(Section& section, bool needed) {
  MatteFrom matte;
  int given = 0;
  const auto take = [&](const char* key, MatteFrom::Kind kind) {
    const std::optional<std::string> name = section.text(key);
    if (!name) return;
    ++given;
    matte = {.kind = kind, .file = section.beside(*name)};
    if (kind != MatteFrom::Kind::kFile) return;
    if (*name == "rest") matte = {.kind = MatteFrom::Kind::kRest};
    if (*name == "paint" || *name == "painted")
      matte = {.kind = MatteFrom::Kind::kPaint, .painted = *name == "painted"};
  };
  take("matte", MatteFrom::Kind::kFile);
  take("scribbles", MatteFrom::Kind::kScribbles);
  take("trimap", MatteFrom::Kind::kTrimap);
  const char* const kRemedyOfMatte =
      "Give one of matte = \"FILE\", matte = \"paint\", matte = \"painted\", scribbles = \"FILE\" and trimap "
      "= \"FILE\"; matte = "
      "\"rest\" is what "
      "all others leave";
  if (given > 1) section.refuse_whole("it has more than one matte", kRemedyOfMatte);
  if (given == 0 && needed) section.refuse_whole("nothing says where it is", kRemedyOfMatte);
  if (given > 0 && !needed)
    section.refuse_whole("it has a matte, though its pixels come with alpha of their own",
                         "Take the matte out");
  return matte;
}

void check_name(const Section& section, const std::string& name) {
  const bool fit = !name.empty() && name.size() <= 60 && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == ' ';
  });
  if (!fit)
    section.refuse("name", fmt::format("\"{}\" is no name of a layer", name.substr(0, 60)),
                   "Give 1 to 60 letters, digits, '-', '_' and spaces");
}

/// Reads the name, and calls the table by it from now on.
void read_name(Section& section, SceneLayer& layer) {
  const std::optional<std::string> name = section.text("name");
  if (!name) section.refuse_whole("it has no name", "Give name = \"oak\"");
  check_name(section, *name);
  layer.name = *name;
  section.rename(*name);
}

template <std::size_t... At>
std::vector<std::string> kind_names(std::index_sequence<At...>) {
  return {std::variant_alternative_t<At, LayerMotion>::kName...};
}
template <std::size_t... At>
void take_kind(LayerMotion& motion, std::size_t kind, std::index_sequence<At...>) {
  ((kind == At ? void(motion.emplace<At>()) : void()), ...);
}
using Kinds = std::make_index_sequence<std::variant_size_v<LayerMotion>>;

template <class Work, std::size_t... At>
void for_each_kind(Work&& work, std::index_sequence<At...>) {
  (work.template operator()<std::variant_alternative_t<At, LayerMotion>>(), ...);
}
template <class Work>
void for_each_kind(Work&& work) {
  for_each_kind(work, Kinds());
}

void read_motion(Section& section, SceneLayer& layer) {
  const auto kind = section.word("motion", kind_names(Kinds()));
  if (!kind)
    section.refuse_whole("it has no motion",
                         "Give motion = \"still\", \"tree\", \"water\", ...; --keys lists them");
  take_kind(layer.motion, *kind, Kinds());
}

void read_matte(Section& section, SceneLayer& layer) {
  if (layer.as<FootageMotion>() == nullptr) {
    layer.matte = matte_from(section, layer.is_cut());
    return;
  }
  for (const char* const key : {"scribbles", "trimap"})  // its matte is among its own keys
    if (section.text(key))
      section.refuse(key, "it is of the picture, and this layer is a film",
                     "Give matte = \"FILE\": a grey picture or film of its shape, white where the layer is");
}

void read_shadow(Section& section, SceneLayer& layer) {
  layer.shadow = line_of(section, "shadow");
  if (!layer.shadow) return;
  if (!layer.is_cut() || layer.as<WaterMotion>() != nullptr || layer.as<CloudMotion>() != nullptr)
    section.refuse("shadow", fmt::format("a layer of motion \"{}\" casts none", layer.kind()),
                   layer.as<CloudMotion>() != nullptr ? "Give shade: shadows of clouds on the ground"
                                                      : "Take the shadow out");
  if (std::abs(layer.shadow->to.y - layer.shadow->from.y) < 1)
    section.refuse(
        "shadow", "it ends in the row in which it begins, where it has no breadth",
        "Let its end lie some pixels lower, or higher for a shadow that falls away from the viewer");
}

void check_glow(const Section& section, const SceneLayer& layer) {
  if (layer.glow > 0 && !layer.brings_frames() && layer.as<WaterMotion>() == nullptr)
    section.refuse("glow", fmt::format("a layer of motion \"{}\" has one light all the time", layer.kind()),
                   "Give it to a fire, a layer of patches, transfer or footage, or to water that glitters");
}

SceneLayer read_layer(Section& section, int place) {
  SceneLayer layer;
  layer.order = place;
  layer.seed = static_cast<std::uint64_t>(place);
  read_keys(section, layer_keys(), layer, kExplained);
  check_glow(section, layer);
  std::visit(
      [&]<class Kind>(Kind& motion) {
        read_keys(section, keys_of<Kind>(), motion, kExplained);
        if constexpr (requires { motion.check(section); }) motion.check(section);
      },
      layer.motion);
  section.done();
  return layer;
}

/// That there is water below the boat, and another boat above a reflection.
void check_boat(const Scene& scene, const BoatMotion& boat, const Section& section) {
  const bool floats = std::ranges::any_of(scene.layers, [&](const SceneLayer& other) {
    return other.as<WaterMotion>() != nullptr && (boat.water.empty() || other.name == boat.water);
  });
  if (!floats)
    section.refuse("water",
                   boat.water.empty() ? "no layer of the scene is water, and a boat rides its waves"
                                      : fmt::format("\"{}\" is no layer of water", boat.water),
                   "Add a layer with motion = \"water\", or let this one be still");
  const bool mirrors = std::ranges::any_of(scene.layers, [&](const SceneLayer& other) {
    const auto* above = other.as<BoatMotion>();
    return above != nullptr && other.name == boat.reflection_of && above->reflection_of.empty();
  });
  if (!boat.reflection_of.empty() && !mirrors)
    section.refuse("reflection_of", fmt::format("\"{}\" is no other boat", boat.reflection_of),
                   "Name the layer of the boat that is mirrored");
}

bool has_gusts(const Scene& scene, const SceneLayer&) {
  return scene.wind.gustiness > 0 || std::ranges::any_of(scene.wind.at, [](const WindKey& then) {
           return then.gustiness.value_or(0) > 0;
         });
}
bool has_shadow(const Scene&, const SceneLayer& layer) { return layer.shadow.has_value(); }
bool glows(const Scene&, const SceneLayer& layer) { return layer.glow > 0; }
bool shades(const Scene&, const SceneLayer& layer) { return layer.as<CloudMotion>()->shade > 0; }
bool shimmers(const Scene&, const SceneLayer& layer) { return layer.as<TreeMotion>()->shimmer_px > 0; }

/// A key that says nothing without another one, or where that is 0.
struct BelongingKey {
  std::string_view table;  // "wind", "layer", or a kind of motion
  const char *key, *to;
  bool (*is_there)(const Scene&, const SceneLayer&);  // the layer: for "wind" any one
};
constexpr BelongingKey kBelonging[] = {{"wind", "width", "gustiness", has_gusts},
                                       {"layer", "shadow_darkness", "shadow", has_shadow},
                                       {"layer", "shadow_softness", "shadow", has_shadow},
                                       {"layer", "shadow_in_still", "shadow", has_shadow},
                                       {"layer", "glow_reach", "glow", glows},
                                       {"tree", "shimmer_size", "shimmer", shimmers},
                                       {"water", "gust_darkening", "the wind's gustiness", has_gusts},
                                       {"clouds", "shade_size", "shade", shades},
                                       {"clouds", "ground", "shade", shades}};

void check_belonging(const Scene& scene, const SceneLayer& layer, std::string_view table,
                     const Section& section) {
  for (const BelongingKey& each : kBelonging)
    if (each.table == table && section.has(each.key) && !each.is_there(scene, layer))
      section.refuse(each.key, fmt::format("it belongs to {}, and there is none", each.to),
                     fmt::format("Give {}, or take {} out", each.to, each.key));
}

/// What layers ask of each other.
void check_layers(const Scene& scene, const std::vector<Section>& sections,
                  std::vector<std::size_t> section_of) {
  std::set<std::string> names{};
  const SceneLayer *rest = nullptr, *shades = nullptr;
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    const SceneLayer& layer = scene.layers[i];
    const Section& section = sections[section_of[i]];
    for (const std::string_view table : {"layer", layer.kind()})
      check_belonging(scene, layer, table, section);
    if (!names.insert(layer.name).second)
      section.refuse("name", fmt::format("two layers are called {}", layer.name),
                     "Give each a name of its own");
    if (i > 0 && scene.layers[i - 1].order == layer.order)
      section.refuse(
          "order",
          fmt::format("{} and {} have one order, {}", scene.layers[i - 1].name, layer.name, layer.order),
          "Give each its own: 1 is nearest. Without order they follow each other as in the file");
    if (rest != nullptr && layer.is_cut())
      section.refuse("order",
                     fmt::format("it lies behind {}, which is the rest and leaves nothing", rest->name),
                     fmt::format("Give {} the greatest order", rest->name));
    if (layer.is_cut() && layer.matte.kind == MatteFrom::Kind::kRest) rest = &layer;
    if (layer.is_cut() && layer.matte.kind == MatteFrom::Kind::kPaint && scene.paint.empty())
      section.refuse("matte", "nothing says which file holds the paint",
                     "Give paint = \"FILE.ora\" at the scene's top");
    if (const auto* boat = layer.as<BoatMotion>()) check_boat(scene, *boat, section);
    if (const auto* clouds = layer.as<CloudMotion>(); clouds != nullptr && clouds->shade > 0) {
      if (shades != nullptr)
        section.refuse("shade", fmt::format("{} shades the ground already", shades->name),
                       "Leave shade to one layer of clouds");
      shades = &layer;
    }
    if (const auto* footage = layer.as<FootageMotion>();
        footage && start_frame(*footage, scene.fps) >= scene.frames)
      section.refuse("start", fmt::format("the scene ends after {:.3g} s", scene.frames / scene.fps),
                     "Let it begin earlier, or the scene have more frames");
  }
}

/// The keys of a wind that changes, in a film of so many seconds.
void read_weather(Section& table, Wind& wind, double film_s) {
  for (Section& section : table.tables("at", kMaxWindKeys)) {
    WindKey key;
    read_keys(section, weather_keys(), key, kExplained);
    section.done();
    const double before = wind.at.empty() ? 0 : wind.at.back().time_s;
    if (!(key.time_s > before))
      section.refuse("time", fmt::format("{} s does not come after {} s", key.time_s, before),
                     "Let times grow from one [[wind.at]] to the next; [wind] itself is the wind at 0 s");
    if (key.time_s > film_s)
      section.refuse("time", fmt::format("{} s lie beyond the scene's end, {:.6g} s", key.time_s, film_s),
                     "Let it be earlier, or the scene have more frames");
    if (!key.speed_m_per_s && !key.direction_deg && !key.gustiness)
      section.refuse_whole("nothing changes", "Give speed, direction or gustiness, or take the table out");
    wind.at.push_back(key);
  }
}

/// That a loop's wind ends as it begins.
void check_closes(const Section& table, const Wind& wind, double film_s) {
  const auto check = [&](const char* key, double first, std::optional<double> WindKey::*value, double whole) {
    double last = first;
    for (const WindKey& each : wind.at) last = (each.*value).value_or(last);
    const double apart = whole > 0 ? std::remainder(last - first, whole) : last - first;
    if (apart == 0) return;
    table.refuse("at", fmt::format("the loop ends with {} {} and begins with {}", key, last, first),
                 fmt::format("Add [[wind.at]] with time = {:.6g} and {} = {}, or set loop = false", film_s,
                             key, first));
  };
  check("speed", wind.speed_m_per_s, &WindKey::speed_m_per_s, 0);
  check("direction", wind.direction_deg, &WindKey::direction_deg, 360);
  check("gustiness", wind.gustiness, &WindKey::gustiness, 0);
}

Scene read_file(Section& file, const std::filesystem::path& name) {
  Scene scene;
  scene.file = name;
  read_keys(file, top_keys(), scene, kExplained);
  if (scene.loop && scene.frames < 2)
    file.refuse("loop", "one frame is no animation to go round", "Ask for 2 frames or more");
  if (auto wind = file.table("wind")) {
    read_keys(*wind, wind_keys(), scene.wind, kExplained);
    const double film_s = scene.frames / scene.fps;
    read_weather(*wind, scene.wind, film_s);
    if (scene.loop) check_closes(*wind, scene.wind, film_s);
    check_belonging(scene, {}, "wind", *wind);
    wind->done();
  }
  std::vector<Section> sections = file.tables("layer", kMaxLayers);
  file.done();
  if (sections.empty()) file.refuse_whole("no layer", "Add a table [[layer]]; --keys explains it");
  std::vector<std::size_t> order;
  std::vector<SceneLayer> layers;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    layers.push_back(read_layer(sections[i], static_cast<int>(i) + 1));
    order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return layers[a].order < layers[b].order; });
  for (const std::size_t i : order) scene.layers.push_back(layers[i]);
  check_layers(scene, sections, order);
  const bool rest = std::any_of(scene.layers.begin(), scene.layers.end(), [](const SceneLayer& layer) {
    return layer.is_cut() && layer.matte.kind == MatteFrom::Kind::kRest;
  });
  // What nobody speaks of stays where it is.
  if (!rest && scene.cut.empty())
    scene.layers.push_back({.name = "(rest)",
                            .order = scene.layers.back().order + 1,
                            .matte = {},
                            .seed = 0,
                            .motion = StillMotion{}});
  return scene;
}

}  // namespace

Scene parse_scene(std::string_view text, const std::filesystem::path& name) {
  const TomlText parsed(text, name, kRemedy);
  Section file = parsed.root();
  return read_file(file, name);
}

Scene read_scene(const std::filesystem::path& path) {
  return parse_scene(toml_file_text(path, kRemedy), path);
}

std::string scene_keys() {
  std::string text =
      "A scene is a TOML file. Files that it names lie beside it. Lines are [x, y, x, y], px of the picture, "
      "(0, 0) its "
      "upper\nleft corner; they can be drawn over the picture instead (marks).\n\n" +
      key_lines(key_texts(top_keys())) + "\n[wind]: one for all layers\n" +
      key_lines(key_texts(wind_keys())) +
      "\n[[wind.at]]: what the wind has become at a moment; from one to the next it changes smoothly. A loop "
      "ends as "
      "it\nbegins\n" +
      key_lines(key_texts(weather_keys())) + "\n[[layer]]: nearest first, or by order\n" +
      key_lines(key_texts(layer_keys()));
  for_each_kind([&]<class Kind>() {
    if (!keys_of<Kind>().empty())
      text += fmt::format("\n{}:\n", Kind::kName) + key_lines(key_texts(keys_of<Kind>()));
  });
  return text;
}

std::vector<SceneRange> scene_ranges() {
  std::vector<SceneRange> ranges;
  const auto add = [&](const char* table, const std::vector<KeyRange>& keys) {
    for (const KeyRange& key : keys) ranges.push_back({table, key.name, key.range, key.slider});
  };
  add("wind", key_ranges(wind_keys()));
  add("wind.at", key_ranges(weather_keys()));
  add("layer", key_ranges(layer_keys()));
  for_each_kind([&]<class Kind>() { add(Kind::kName, key_ranges(keys_of<Kind>())); });
  return ranges;
}

SceneRange scene_range(const std::string& table, const std::string& key) {
  for (const SceneRange& each : scene_ranges())
    if (each.table == table && each.key == key) return each;
  throw Error(ErrorKind::kUsage, table + "." + key, "a scene has no such number");
}

std::string first_scene(const std::string& picture, cv::Size size) {
  const int w = size.width, h = size.height;
  return fmt::format(R"(# A scene for freshet synth scene. freshet synth scene --keys explains every key;
# --draw shows what was understood. Lines are [x, y, x, y] in px of the picture of {0} x {1} px.
picture = "{2}"
# marks = "marks.svg"   # lines drawn over the picture, each in a group named as its layer, instead of those below
frames = 100
fps = 25
loop = true

[wind]
speed = 5          # m/s
direction = 0      # degrees, where it blows to: 0 right, 90 away from the viewer
gustiness = 0      # 0 to 1: gusts that cross the picture
seed = 1

# [[wind.at]]      # weather: what the wind has become at a time, s; a loop ends as it begins
# time = 2
# speed = 12
# [[wind.at]]
# time = 4
# speed = 5

# Layers from the nearest to the furthest. A matte is a grey picture, white where the layer is; scribbles and trimap
# are the other ways. Take away the signs # before what the picture has.

# [[layer]]
# name = "oak"
# scribbles = "oak.png"
# motion = "tree"
# armature = [{3}, {4}, {3}, {5}]   # from the root to the tip
# frequency = 0.5                   # Hz

# [[layer]]
# name = "boat"
# matte = "boat.png"
# motion = "boat"
# hull = [{6}, {4}, {7}, {4}]       # along the waterline

# [[layer]]
# name = "lake"
# matte = "lake.png"
# motion = "water"
# horizon = [0, {8}, {0}, {8}]
# mirrors = true                    # and the clouds and trees that move behind it
# roughness = 25                    # greater: shorter waves

[[layer]]
name = "rest"
matte = "rest"
motion = "still"   # clouds, if it is all sky
)",
                     w, h, picture, w / 4, 3 * h / 4, h / 4, w / 2, 3 * w / 4, h / 2);
}

}  // namespace freshet::synth::scene
