#include "studio/ways/way_plan.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "studio/drawing/toml_text.h"
#include "studio/ways/design_scene.h"
#include "studio/ways/layer_scene.h"
#include "studio/ways/sweep_recipe.h"

namespace freshet::studio {
namespace {

constexpr int kDraftSide = 400, kFullSide = 1280;  // px of the film's longer side, at most

/// Even, as H.264 wants it.
cv::Size film_size(const Design& design, cv::Size picture) {
  const int longest = design.full ? kFullSide : kDraftSide;
  const double factor = std::max(1.0, std::max(picture.width, picture.height) / static_cast<double>(longest));
  const auto even = [&](int side) { return std::max(16, 2 * cvRound(side / factor / 2)); };
  return {even(picture.width), even(picture.height)};
}

/// A motion that was designed, and then given the look of a clip over the picture.
WayPlan plan_design(const Document& document) {
  const Design& design = document.design;
  const auto is_source = [](const Drawn& line) { return line.adds; };
  if (std::none_of(design.sources.begin(), design.sources.end(), is_source))
    throw Error(ErrorKind::kUsage, "design", "nothing comes from anywhere", "Draw a source");
  if (!design.look.empty() && document.store.empty())
    throw Error(ErrorKind::kUsage, "design", "the clip that it shall look like has no store",
                "Choose one under Look");
  WayPlan plan{.folder = "design",
               .commands = {{"synth", "simulate", "ways/design/scene.toml", "-o", "ways/design/motion",
                             "--overwrite"}},
               .film = "ways/design/motion/preview.mp4"};
  if (design.look.empty()) return plan;
  plan.film = "ways/design/film.mp4";
  plan.store = document.store;
  plan.commands.push_back({"synth", "transfer", "--design", "ways/design/motion", "--store", document.store,
                           "--exemplar", design.look, "--ground", design.ground, "-o",
                           "ways/design/fluid.mkv", "--over", "ways/design/behind.png", "--composite",
                           plan.film, "--restart", "--overwrite"});
  return plan;
}

std::vector<WayFile> design_files(const Design& design, const cv::Mat& picture) {
  const cv::Size size = film_size(design, picture.size());
  std::vector<WayFile> files{{"scene.toml", design_scene(design, picture.size(), size)}};
  if (design.look.empty()) return files;
  cv::Mat behind;
  cv::resize(picture, behind, size, 0, 0, cv::INTER_AREA);
  std::vector<std::uint8_t> png;
  cv::imencode(".png", behind, png);
  files.push_back({"behind.png", {png.begin(), png.end()}});
  return files;
}

/// What was said of the paths, as `freshet synth stills --keys` explains it.
std::string stills_edits(const Stills& stills) {
  std::map<std::string, std::pair<std::vector<std::string>, std::vector<std::string>>> of_region;
  for (const StillsPath& path : stills.paths) {
    auto& [refused, turned] = of_region[path.region];
    (path.refused ? refused : turned).push_back(toml_list(path.names));
  }
  std::string toml = fmt::format("speed = {}\nsplit = {}\n", stills.speed, stills.split);
  for (const auto& [region, paths] : of_region)
    toml += fmt::format("[[region]]\nname = {}\nrefuse = [{}]\nturn = [{}]\n", toml_text(region),
                        fmt::join(paths.first, ", "), fmt::join(paths.second, ", "));
  return toml;
}

/// A moving scene from the stills that lie in the way's folder.
WayPlan plan_stills(const Stills& stills) {
  WayPlan plan{.folder = "stills",
               .commands = {{"synth", "stills", "ways/stills/pictures", "--edits", "ways/stills/edits.toml",
                             "--seconds", fmt::format("{}", stills.seconds), "-o", "ways/stills/film.mp4",
                             "--sheet", "ways/stills/regions.png", "--page", "ways/stills/page.html",
                             "--cache", "ways/stills/kept", "--json", "--overwrite"}},
               .film = "ways/stills/film.mp4",
               .answer = "found.json",
               .shown = {"regions.png", "page.html"}};
  if (stills.loop) plan.commands[0].emplace_back("--loop");
  if (!stills.full) plan.commands[0].emplace_back("--preview");
  return plan;
}

std::string clip_store(const Document& document) { return document.endless.dropped ? "" : document.store; }

/// The clip that is chosen, as `synth flowlines` is told of it.
std::vector<std::string> flowlines_of(const Document& document) {
  const Endless& endless = document.endless;
  if (endless.clip.empty())
    throw Error(ErrorKind::kUsage, "endless", "no clip is chosen", "Choose one, or drop one");
  std::vector<std::string> words{"synth", "flowlines"};
  if (endless.dropped) {
    words.push_back(own_clip_path(endless.clip));
  } else {
    if (document.store.empty())
      throw Error(ErrorKind::kUsage, "endless", "the clip has no store", "Choose one under Look");
    words.insert(words.end(), {"--store=" + document.store, "--clip=" + endless.clip});
  }
  if (endless.moving_camera) words.emplace_back("--moving-camera");
  return words;
}

/// A name for what was found in a clip: what was found in another one is not taken for it.
std::string found_name(const Document& document) {
  const Endless& endless = document.endless;
  const std::string of = (endless.dropped ? "" : document.store) + "\n" + endless.clip;
  return fmt::format("found-{:06x}", std::hash<std::string>()(of) & 0xffffffu);
}

/// The lines that are found in the clip.
WayPlan plan_lines(const Document& document) {
  const std::string found = found_name(document);
  WayPlan plan{.folder = "flowlines",
               .commands = {flowlines_of(document)},
               .film = "",
               .answer = found + ".json",
               .shown = {found + ".svg"},
               .store = clip_store(document)};
  std::vector<std::string>& words = plan.commands[0];
  words.insert(words.end(), {"--frames", "1", "-o", "ways/flowlines/first.png", "--lines-out",
                             "ways/flowlines/" + found + ".svg", "--json", "--overwrite"});
  return plan;
}

/// The clip without an end, along its lines, or where they were moved.
WayPlan plan_flowlines(const Document& document) {
  const Endless& endless = document.endless;
  WayPlan plan{.folder = "flowlines",
               .commands = {flowlines_of(document)},
               .film = "ways/flowlines/film.mp4",
               .answer = "made.json",
               .shown = {"drawn.png"},
               .store = clip_store(document)};
  std::vector<std::string>& words = plan.commands[0];
  const auto say = [&](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
  say({"--frames", std::to_string(endless.frames)});
  if (endless.loop) say({"--loop"});
  if (!endless.lines.empty()) say({"--lines", "ways/flowlines/lines.svg"});
  if (!endless.edited.empty()) {
    say({"--edited", "ways/flowlines/edited.svg"});
    if (endless.join > 0) say({"--join", fmt::format("{:g}", endless.join)});
    if (endless.stretched) say({"--correspondence", "stretched"});
    if (endless.ground != "none") say({"--ground", endless.ground});
  }
  say({"-o", plan.film, "--draw", "ways/flowlines/drawn.png", "--json", "--overwrite"});
  return plan;
}

std::vector<WayFile> flowlines_files(const Endless& endless) {
  std::vector<WayFile> files;
  if (!endless.lines.empty()) files.push_back({"lines.svg", clip_lines_svg(endless.lines)});
  if (!endless.edited.empty()) files.push_back({"edited.svg", clip_lines_svg(endless.edited)});
  return files;
}

/// The picture in layers under one wind.
WayPlan plan_scene(const Document& document) {
  const Layered& layered = document.layered;
  const bool searches = std::any_of(layered.layers.begin(), layered.layers.end(),
                                    [](const DrawnLayer& layer) { return layer.motion == "patches"; });
  if (layered.layers.empty()) throw Error(ErrorKind::kUsage, "layers", "there is none", "Add one");
  return {.folder = "scene",
          .commands = {{"synth", "scene", "ways/scene/scene.toml", "-o", "ways/scene/film.mp4", "--draw",
                        "ways/scene/understood.png", "--json", "--overwrite"}},
          .film = "ways/scene/film.mp4",
          .answer = "made.json",
          .shown = {"understood.png"},
          .store = searches ? document.store : ""};
}

/// The animation under several settings, whose films lie beside each other.
WayPlan plan_sweep(const Document& document) {
  const std::vector<std::string> varied = sweep_words(document);
  WayPlan plan{.folder = "sweep",
               .commands = {{"synth", "sweep", "--config", "ways/sweep/sweep.toml"}},
               .film = "",
               .answer = "made.json",
               .shown = {"sheet.png"},
               .store = document.store,
               .animates = true};
  std::vector<std::string>& words = plan.commands[0];
  words.insert(words.end(), varied.begin(), varied.end());
  words.insert(words.end(), {"-o", "ways/sweep", "--json", "--overwrite"});
  for (std::size_t i = 1; i <= swept(document.sweep); ++i) plan.shown.push_back(fmt::format("{:02}.mp4", i));
  return plan;
}

}  // namespace

WayPlan plan_way(const std::string& way, const Document& document) {
  if (way == "design") return plan_design(document);
  if (way == "stills") return plan_stills(document.stills);
  if (way == "flowlines") return plan_flowlines(document);
  if (way == "lines") return plan_lines(document);
  if (way == "scene") return plan_scene(document);
  if (way == "sweep") return plan_sweep(document);
  throw Error(ErrorKind::kNotFound, way, "there is no such way");
}

std::vector<WayFile> way_files(const std::string& way, const Document& document, const cv::Mat& picture,
                               const RecipeFiles& files) {
  if (way == "design") return design_files(document.design, picture);
  if (way == "stills") return {{"edits.toml", stills_edits(document.stills)}};
  if (way == "flowlines") return flowlines_files(document.endless);
  if (way == "scene")
    return layer_scene(document.layered, picture.size(),
                       {.picture = "../../" + files.picture,
                        .store = document.store,
                        .design = document.design.look.empty() ? "" : "../design/fluid.mkv",
                        .clips = "../flowlines/clips"});
  if (way == "sweep") return {{"sweep.toml", sweep_toml(document, files)}};
  return {};
}

}  // namespace freshet::studio
