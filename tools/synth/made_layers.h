// tools/synth/made_layers.h — layers of a scene that other commands make: patches of a store, transferred looks,
// footage.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/rendering/layer_frames.h"
#include "synth/scene/rendering/scene_animation.h"
#include "synth/scene/scene.h"
#include "tools/console/run_context.h"

namespace freshet::tools {

/// The frames of a layer whose motion is patches, transfer or footage. What takes its time runs beside the
/// rendering, a few frames ahead of it.
std::unique_ptr<synth::scene::LayerFrames> frames_of_layer(const synth::scene::Scene& scene,
                                                           const synth::scene::SceneLayer& layer,
                                                           const synth::scene::LayerPixels& pixels,
                                                           const RunContext& context);

}  // namespace freshet::tools
