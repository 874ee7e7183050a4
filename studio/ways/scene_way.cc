#include <algorithm>

#include "freshet/error.h"
#include "studio/ways/layer_scene.h"
#include "studio/ways/way.h"
#include "synth/scene/frames/footage_reader.h"

namespace freshet::studio {
namespace {

/// The picture in layers under one wind.
WayPlan plan_scene(const Document& document) {
  const DrawnScene& scene = document.scene;
  const bool searches = std::any_of(scene.layers.begin(), scene.layers.end(), [](const DrawnLayer& layer) {
    return layer.motion == "patches" ||
           (layer.motion == "tree" && !layer.sway_clip.empty() && !layer.sway_dropped);
  });
  if (scene.layers.empty()) throw Error(ErrorKind::kUsage, "layers", "there is none", "Add one");
  return {.folder = "scene",
          .commands = {{"synth", "scene", "ways/scene/scene.toml", "-o", "ways/scene/film.mp4", "--draw",
                        "ways/scene/understood.png", "--json", "--overwrite"}},
          .film = "ways/scene/film.mp4",
          .fluid = {},
          .layers = true,
          .answer = "made.json",
          .shown = {"understood.png"},
          .store = searches ? document.store : ""};
}

std::vector<WayFile> scene_files(const WayInput& input) {
  const Document& document = input.document;
  return layer_scene(document.scene, input.picture.size(),
                     {.picture = "../../" + input.files.picture,
                      .store = document.store,
                      .design = document.design.look.empty() ? "" : "../design/fluid.mkv",
                      .flowlines = document.flowlines.clip.empty() ? "" : "../flowlines/film.mp4",
                      .stills = "../stills/film.mp4",
                      .clips = "../flowlines/clips",
                      .film_size = [folder = input.folder / "ways/scene"](const std::string& film) {
                        return synth::scene::FootageReader((folder / film).lexically_normal()).next().size();
                      }});
}

}  // namespace

extern const Way kSceneWay{.name = "scene", .plan = plan_scene, .files = scene_files};

}  // namespace freshet::studio
