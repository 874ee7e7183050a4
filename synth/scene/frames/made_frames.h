// synth/scene/frames/made_frames.h — layers that other ways to synthesise make: transferred looks, patches, footage.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include <opencv2/core.hpp>

#include "hints/strokes.h"
#include "synth/scene/frames/pushed_frames.h"
#include "synth/scene/rendering/layer_frames.h"
#include "synth/scene/rendering/scene_animation.h"
#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// What of the picture a layer of patches animates.
struct PatchesTarget {
  const Scene* scene = nullptr;
  const SceneLayer* layer = nullptr;
  const PatchesMotion* motion = nullptr;
  cv::Mat picture;                       // CV_8UC3; its colours go on beyond the matte
  cv::Mat matte;                         // CV_8U
  std::vector<hints::Stroke> strokes{};  // drawn in the scene for this layer
};
/// Makes a layer of patches: pushes all of its frames, and their motion where it is asked for and the method knows it.
using PatchesMaker = std::function<void(const PatchesTarget&, const PushedFrames::Sinks&)>;

/// The frames of a layer whose motion is patches, transfer or footage. What takes its time runs beside the rendering.
/// patches   outlives what is returned, and so do scene and layer.
/// Throws    Error{kInput} naming the file: as the readers of designs, exemplars and footage; a design too short for a
///           loop.
std::unique_ptr<LayerFrames> frames_of_layer(const Scene& scene, const SceneLayer& layer,
                                             const LayerPixels& pixels, const PatchesMaker& patches,
                                             const std::stop_token& stop,
                                             FrameWork work = FrameWork::kFrames);

}  // namespace freshet::synth::scene
