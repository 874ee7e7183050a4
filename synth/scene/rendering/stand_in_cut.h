// synth/scene/rendering/stand_in_cut.h — layers cut with scissors, and what lies behind them continued smoothly.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/rendering/scene_animation.h"

namespace freshet::synth::scene {

/// One a layer. picture   CV_32FC3. mattes   CV_8U, empty for the rest and for what brings its own pixels.
std::vector<LayerPixels> stand_in_cut(const cv::Mat& picture, const std::vector<cv::Mat>& mattes,
                                      const Scene& scene);

}  // namespace freshet::synth::scene
