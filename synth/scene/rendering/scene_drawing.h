// synth/scene/rendering/scene_drawing.h — what of a scene was understood, over its picture.
#pragma once

#include <span>

#include <opencv2/core.hpp>

#include "synth/scene/rendering/scene_animation.h"
#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// Layers tinted, each in a colour of its own with its name; armatures as arrows from root to tip, hull lines, and the
/// plane of water as a grid of squares of camera_height metres. picture   CV_8UC3. Returns CV_8UC3.
cv::Mat draw_scene(const cv::Mat& picture, const Scene& scene, std::span<const LayerPixels> pixels);

}  // namespace freshet::synth::scene
