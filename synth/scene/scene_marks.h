// synth/scene/scene_marks.h — armatures, horizons and hull lines drawn over the picture.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "hints/strokes.h"
#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// Reads the scene's drawing, if it has one, and gives each layer what names it. A line belongs to the layer that
/// its data-layer names; else to the one after which it or the nearest group around it is called (by label or id; case,
/// '_', '-' and spaces are alike, and a number at the end may follow: oak-2). It is an armature, a horizon or a
/// hull line by that layer's motion, from its first point to its last. Lines of the scene file stay beside armatures,
/// and stand above a drawn horizon or hull.
/// notices  for a person: lines that name no layer, or one that needs none.
/// Throws   Error{kInput} naming the file, the line and the remedy; as read_svg_strokes; for a layer without the line
///          that its motion needs, and for one of no length.
void read_marks(Scene& scene, cv::Size picture, std::vector<std::string>* notices = nullptr);

/// What of the drawing belongs to a layer of patches: its strokes.
std::vector<hints::Stroke> strokes_of(const Scene& scene, const SceneLayer& layer, cv::Size picture);

/// Whether a layer's lines fit where it is. alpha   CV_32F, the layer's; the picture's size.
/// Throws   Error{kInput} naming scene, layer and remedy: a layer that is nowhere, an armature whose
///          half that is in the picture lies outside its layer, a horizon below more than a tenth of its water, a hull
///          line far from its boat.
void check_marks(const Scene& scene, const SceneLayer& layer, const cv::Mat& alpha,
                 std::vector<std::string>* notices);

}  // namespace freshet::synth::scene
