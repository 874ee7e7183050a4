// studio/ways/layer_scene.h — layers that were painted over a picture, as the files of `synth scene`.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "studio/drawing/drawn_scene.h"
#include "studio/ways/way_file.h"

namespace freshet::studio {

/// What a scene names from where it lies.
struct SceneFiles {
  std::string picture;    // "../../picture.png"
  std::string store;      // of layers of patches; empty: none
  std::string design;     // what Design makes, with alpha; empty: it has no look
  std::string flowlines;  // the clip without an end; empty: no clip is chosen
  std::string stills{};   // what Stills makes
  std::string clips;      // the folder of clips that were dropped
  /// px, of a film that the scene names; asked where one was painted over. Throws as FootageReader.
  std::function<cv::Size(const std::string& film)> film_size = {};
};

/// scene.toml, marks.svg where lines were drawn, and a grey matte or scribbles for each layer that has its own:
/// layer-1.png and so on. That of a film is of the film's size, where paint lies over it. size   px, of the picture.
/// Throws Error{kUsage} for a layer that is nowhere, or lacks its line or store, saying what is missing.
std::vector<WayFile> layer_scene(const DrawnScene& scene, cv::Size size, const SceneFiles& files);

}  // namespace freshet::studio
