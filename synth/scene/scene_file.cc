#include "synth/scene/scene_file.h"

#include <algorithm>
#include <bit>
#include <set>

#include <fmt/format.h>

#include "freshet/error.h"
#include "synth/toml/section.h"

namespace freshet::synth::scene {
namespace {

constexpr const char* kRemedy =
    "Give a TOML file; freshet synth scene --init PICTURE -o SCENE.toml makes one";
constexpr std::size_t kMaxLayers = 256;
constexpr double kFarPx = 1e6;
const std::vector<std::string> kMotions{"still",  "tree",    "water",    "boat",
                                        "clouds", "patches", "transfer", "footage"};

void read_wind(Section section, Wind& wind) {
  section.read("speed", wind.speed_m_per_s, {0.0, 60.0});
  section.read("direction", wind.direction_deg, {-360.0, 360.0});
  section.read("turbulence", wind.turbulence, {0.0, 1.0});
  section.read("kappa", wind.kappa_m, {0.01, 1e5});
  section.read("gustiness", wind.gustiness, {0.0, 1.0});
  section.read("width", wind.width_m, {0.1, 1e5});
  std::int64_t seed = 1;
  section.read("seed", seed, {0.0, 9e15});
  wind.seed = static_cast<std::uint64_t>(seed);
  section.done();
}

Line line_of(const std::vector<double>& row) { return {{row[0], row[1]}, {row[2], row[3]}}; }

std::optional<Line> read_line(Section& section, const std::string& key) {
  const std::vector<std::vector<double>> rows = section.rows(key, 4, {-kFarPx, kFarPx});
  if (rows.empty()) return {};
  if (rows.size() > 1) section.refuse(key, fmt::format("one line is expected, not {}", rows.size()));
  return line_of(rows[0]);
}

/// What is usual for each kind of plant; every key can still be given.
void read_plant(Section& section, TreeMotion& tree) {
  const auto plant = section.word("plant", {"tree", "flower", "grass"});
  if (!plant || *plant == 0) return;
  // Stems of half a metre to a whole one swing at one to three hertz, a tenth of critically damped (de Langre 2008).
  tree.frequency_hz = 1.6;
  tree.damping_per_s = 2;
  tree.mass = *plant == 1 ? 0.3 : 0.03;
  if (*plant == 2) {
    tree.shimmer_px = 1;
    tree.stand = true;
  }
}

void read_tree(Section& section, TreeMotion& tree) {
  read_plant(section, tree);
  for (const std::vector<double>& row : section.rows("armature", 4, {-kFarPx, kFarPx}))
    tree.armatures.push_back(line_of(row));
  section.read("frequency", tree.frequency_hz, {0.05, 10.0});
  section.read("damping", tree.damping_per_s, {0.01, 100.0});
  section.read("mass", tree.mass, {0.01, 1e5});
  section.read("foreshortening", tree.foreshortening, {0.0, 1.0});
  section.read("shimmer", tree.shimmer_px, {0.0, 20.0});
  section.read("shimmer_size", tree.shimmer_size_px, {4.0, 500.0});
}

void read_water(Section& section, WaterMotion& water) {
  water.horizon = read_line(section, "horizon");
  double value = 0;
  if (section.has("focal")) section.read("focal", value, {1.0, kFarPx}), water.focal_px = value;
  section.read("camera_height", water.camera_height_m, {0.01, 1e4});
  section.read("tile", water.tile, {32.0, 1024.0});
  if (!std::has_single_bit(static_cast<unsigned>(water.tile)))
    section.refuse("tile", fmt::format("{} is no power of 2", water.tile), "Give 64, 128, 256 or 512");
  if (section.has("tile_size")) section.read("tile_size", value, {0.01, 1e6}), water.tile_m = value;
  section.read("roughness", water.roughness, {0.01, 1e5});
  if (section.has("amplitude")) section.read("amplitude", value, {0.0, 1000.0}), water.amplitude = value;
  section.read("against", water.against, {0.0, 1.0});
  if (const auto mapping = section.word("mapping", {"displacement", "normals"}))
    water.mapping = *mapping == 1 ? WaterMapping::kNormals : WaterMapping::kDisplacement;
  water.mirrors = section.flag("mirrors", false);
  if (const auto edge = section.word("edge", {"held", "moving"})) water.edge_moves = *edge == 1;
  if (water.mirrors && water.edge_moves)
    section.refuse("mirrors", "what is mirrored lies in an outline that is held, and edge is \"moving\"",
                   "Take one of the two out");
  section.read("gust_darkening", water.gust_darkening, {0.0, 1.0});
  // What was asked for only to be read must be known all the same.
  section.find("focal"), section.find("tile_size"), section.find("amplitude");
}

void read_boat(Section& section, BoatMotion& boat) {
  boat.hull = read_line(section, "hull");
  boat.water = section.text("water").value_or("");
  section.read("heave", boat.heave, {0.0, 100.0});
  section.read("roll", boat.roll, {0.0, 100.0});
  boat.reflection_of = section.text("reflection_of").value_or("");
}

void read_clouds(Section& section, CloudMotion& clouds) {
  double speed = 0;
  if (section.has("speed")) section.read("speed", speed, {-1e4, 1e4}), clouds.speed_px_per_s = speed;
  section.read("far_speed", clouds.far_speed, {0.0, 1.0});
  section.find("speed");
}

std::filesystem::path read_path(Section& section, const std::string& key, bool needed) {
  const std::optional<std::string> name = section.text(key);
  if (!name && needed)
    section.refuse_whole(fmt::format("it needs {}", key), "freshet synth scene --keys explains it");
  return name ? section.beside(*name) : std::filesystem::path();
}

cv::Point read_place(Section& section) {
  Vec2 at{};
  section.read("at", at, {-1e5, 1e5});
  return {cvRound(at.x), cvRound(at.y)};
}

void read_patches(Section& section, PatchesMotion& patches) {
  patches.store = read_path(section, "store", true);
  patches.class_name = section.text("class").value_or("");
  patches.strokes = read_path(section, "strokes", false);
  patches.options = section.texts("options");
}

void read_transfer(Section& section, TransferMotion& transfer) {
  transfer.design_alpha = read_path(section, "design_alpha", true);
  transfer.design_flow = read_path(section, "design_flow", true);
  transfer.exemplar = read_path(section, "exemplar", true);
  transfer.exemplar_alpha = read_path(section, "exemplar_alpha", false);
  if (const auto ground = section.word("ground", {"none", "black", "white"}))
    transfer.ground = static_cast<ExemplarGround>(*ground);
  transfer.at = read_place(section);
}

void read_footage(Section& section, FootageMotion& footage) {
  footage.file = read_path(section, "file", true);
  footage.at = read_place(section);
  section.read("width", footage.width, {1, 65536});
}

MatteFrom read_matte(Section& section, bool needed) {
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

SceneLayer read_layer(Section& section, int place) {
  SceneLayer layer;
  const std::optional<std::string> name = section.text("name");
  if (!name) section.refuse_whole("it has no name", "Give name = \"oak\"");
  check_name(section, *name);
  layer.name = *name;
  section.rename(*name);
  layer.order = place;
  section.read("order", layer.order, {1.0, 1e6});
  std::int64_t seed = place;
  section.read("seed", seed, {0.0, 9e15});
  layer.seed = static_cast<std::uint64_t>(seed);
  const auto motion = section.word("motion", kMotions);
  if (!motion)
    section.refuse_whole("it has no motion",
                         "Give motion = \"still\", \"tree\", \"water\", ...; --keys lists them");
  layer.kind = static_cast<MotionKind>(*motion);
  layer.matte = read_matte(section, layer.is_cut());
  switch (layer.kind) {
    case MotionKind::kStill:
      break;
    case MotionKind::kTree:
      read_tree(section, layer.tree);
      break;
    case MotionKind::kWater:
      read_water(section, layer.water);
      break;
    case MotionKind::kBoat:
      read_boat(section, layer.boat);
      break;
    case MotionKind::kClouds:
      read_clouds(section, layer.clouds);
      break;
    case MotionKind::kPatches:
      read_patches(section, layer.patches);
      break;
    case MotionKind::kTransfer:
      read_transfer(section, layer.transfer);
      break;
    case MotionKind::kFootage:
      read_footage(section, layer.footage);
      break;
  }
  section.done();
  return layer;
}

/// What layers ask of each other.
void check_layers(const Scene& scene, const std::vector<Section>& sections,
                  std::vector<std::size_t> section_of) {
  std::set<std::string> names{};
  const SceneLayer* rest = nullptr;
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    const SceneLayer& layer = scene.layers[i];
    const Section& section = sections[section_of[i]];
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
    if (layer.kind != MotionKind::kBoat) continue;
    const auto find = [&](const std::string& name, MotionKind kind) {
      return std::any_of(scene.layers.begin(), scene.layers.end(), [&](const SceneLayer& other) {
        return other.kind == kind && (name.empty() || other.name == name);
      });
    };
    if (!find(layer.boat.water, MotionKind::kWater))
      section.refuse("water",
                     layer.boat.water.empty() ? "no layer of the scene is water, and a boat rides its waves"
                                              : fmt::format("\"{}\" is no layer of water", layer.boat.water),
                     "Add a layer with motion = \"water\", or let this one be still");
    const bool mirrors_boat =
        std::any_of(scene.layers.begin(), scene.layers.end(), [&](const SceneLayer& other) {
          return other.kind == MotionKind::kBoat && other.name == layer.boat.reflection_of &&
                 other.boat.reflection_of.empty();
        });
    if (!layer.boat.reflection_of.empty() && !mirrors_boat)
      section.refuse("reflection_of", fmt::format("\"{}\" is no other boat", layer.boat.reflection_of),
                     "Name the layer of the boat that is mirrored");
  }
}

Scene read_file(Section& file, const std::filesystem::path& name) {
  Scene scene;
  scene.file = name;
  scene.picture = read_path(file, "picture", true);
  scene.marks = read_path(file, "marks", false);
  scene.paint = read_path(file, "paint", false);
  scene.cut = read_path(file, "cut", false);
  file.read("frames", scene.frames, {1.0, 1e5});
  file.read("fps", scene.fps, {1.0, 240.0});
  scene.loop = file.flag("loop", false);
  if (scene.loop && scene.frames < 2)
    file.refuse("loop", "one frame is no animation to go round", "Ask for 2 frames or more");
  if (auto wind = file.table("wind")) read_wind(*wind, scene.wind);
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
                            .kind = MotionKind::kStill,
                            .seed = 0});
  return scene;
}

}  // namespace

const char* to_string(MotionKind kind) { return kMotions[static_cast<std::size_t>(kind)].c_str(); }

Scene parse_scene(std::string_view text, const std::filesystem::path& name) {
  const TomlText parsed(text, name, kRemedy);
  Section file = parsed.root();
  return read_file(file, name);
}

Scene read_scene(const std::filesystem::path& path) {
  return parse_scene(toml_file_text(path, kRemedy), path);
}

std::string scene_keys() {
  return R"(A scene is a TOML file. Files that it names lie beside it. Lines are [x, y, x, y], px of the picture,
(0, 0) its upper left corner; they can be drawn over the picture instead (marks).

picture    the still (PNG, JPEG, TIFF, EXR); needed
marks      SVG over it: a line whose group, label, id or data-layer is a layer's name. It is an armature (from root
           to tip) of a tree, the horizon of water, the hull line of a boat, a stroke of patches
paint      OpenRaster (.ora: Krita, GIMP, MyPaint) with a layer of paint for each layer whose matte is "paint"
           or "painted"
cut        OpenRaster that freshet synth layers wrote, maybe painted over: these layers are moved, none is cut
frames     96       1 to 100000
fps        25       frames per second, 1 to 240
loop       false    the last frame runs into the first: all motion has the animation's length as its period

[wind]     one for all layers
speed      5        m/s, 0 to 60
direction  0        degrees, where it blows to, seen from above: 0 right, 90 away from the viewer, 180 left
turbulence .25      standard deviation of its speed, fractions of it, 0 to 1
kappa      100      m: above speed / kappa hertz its spectrum falls with the power -5/3 (Eq. 8)
gustiness  0        how much of the turbulence crosses the picture at the wind's speed: trees bend one after the
                    other, water darkens; 0 to 1, 0 as in the paper
width      30       m, of the picture, for gusts
seed       1        another seed, another wind

[[layer]]  nearest first, or by order
name       letters, digits, '-', '_', spaces; needed
order      [place in the file]   1 is nearest
matte      a grey picture, white where the layer is, or one with alpha; "paint": where its paint is; "painted": and
           its colours are the paint's too; "rest": what all others leave.
scribbles, trimap   instead: strokes on the layer (white, green) and beside it (black, red); white, black and grey
seed       [place in the file]   of this layer's own randomness
motion     still, tree, water, boat, clouds, patches, transfer or footage; needed

tree:
armature       [x, y, x, y] or a list of such lines, from root to tip, unless marks has them
plant          "tree", or "flower", "grass": then frequency 1.6, damping 2, mass .3 (flower) or .03 (grass, with
               shimmer 1) are what is usual. Grass sways as a stand: its lines have one turbulence
frequency      .5    Hz, natural, .05 to 10
damping        .6    1/s, .01 to 100
mass           6     kg for each N that 1 m/s of wind makes, .01 to 100000: displacements are in lengths of the line
foreshortening 0     of the length, lost and won for a displacement of one length, 0 to 1
shimmer        0     px, standard deviation of the leaves' own motion, 0 to 20
shimmer_size   12    px, of what shimmers together, 4 to 500

water:
horizon        [x, y, x, y] on the horizon, unless marks has it
focal          [1.2 times the picture's longer side]   px
camera_height  .5    m above the water, .01 to 10000
tile           256   samples a side, a power of 2, 32 to 1024
tile_size      [25 speed^2 / g]   m, a tile's side at roughness 1
roughness      25    waves are so many times shorter than those of a sea, .01 to 100000
amplitude      [.3; with normals .04]    1: as high as a sea's of this roughness, 0 to 1000
against        .3    amplitude of waves against the wind, 0 to 1; 1 as in the paper
mapping        "displacement": what lies on the water is lifted; "normals": what is mirrored moves as the surface tilts
               [normals where the water is seen nowhere more steeply than at 17 degrees, as most lakes are]
mirrors        false   true: what moves above the horizon, but boats, moves mirrored in it too, as much as the
                       still's colours say; with edge = "held"
edge           "held"           or "moving": the outline moves with the water (the paper)
gust_darkening .15   of the light, under a gust of one standard deviation, 0 to 1; with gustiness alone

boat:
hull           [x, y, x, y] along the waterline, unless marks has it
water          [the first]   the layer that it floats on
heave, roll    1     how much of the water's, 0 to 100
reflection_of  the boat that this layer mirrors: it rolls the other way

clouds:
speed          [wind along the picture, .6 % of its width a second for each m/s]   px/s, negative to the left
far_speed      1     at the layer's lowest row, fractions of the speed at its highest, 0 to 1

patches:       as freshet synth animate
store          the store file; needed
class          [all]   of its clips
strokes        SVG or JSON [those of marks that name the layer]
options        further options of freshet synth animate, word by word: ["--direction", "down"]

transfer:      as freshet synth transfer; brings its own pixels, and has no matte. In a loop its last frames go over
               into those before its first: its design has 4 to 24 frames more than the scene
design_alpha, design_flow, exemplar   folders, patterns or videos; needed
exemplar_alpha masks of the exemplar [its own alpha]
ground         "none"   or "black": it is light on black, as fire; "white": dark on white, as smoke
at             [0, 0]   px, of its upper left corner

footage:       brings its own pixels; where it is shorter, and in a loop, its end goes over into its beginning
file           a numbered sequence (f.####.png) or video with alpha; needed
at             [0, 0]   px, of its upper left corner
width          [its own] px that it is shown wide; its height goes with it
)";
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
