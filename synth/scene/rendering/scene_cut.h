// synth/scene/rendering/scene_cut.h — a scene's picture taken apart into its layers.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "media/picture/picture.h"
#include "synth/scene/layers/cut_layers.h"
#include "synth/scene/rendering/scene_animation.h"
#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// The mattes of the layers that are cut, nearest first, as their files say; how far each can uncover what lies behind
/// it follows from its motion.
/// notices   for a person, when not null.
/// Throws    Error{kInput} naming the file: missing, of another size than the picture, unfit as a matte; a .ora that is
///           cut short, or without the layer.
std::vector<LayerMatte> layer_mattes(const Scene& scene, const media::Still& still,
                                     std::vector<std::string>* notices);

/// Pixels of every layer of the scene, empty for those that bring their own: cut from the picture, or read from
/// the scene's `cut`. Throws as layer_mattes and cut_layers; as from_paint.
std::vector<LayerPixels> cut_scene(const Scene& scene, const media::Still& still,
                                   const CutOptions& options = {}, const CutProgress& progress = {},
                                   std::vector<std::string>* notices = nullptr, std::stop_token stop = {});

}  // namespace freshet::synth::scene
