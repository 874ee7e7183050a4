// synth/scene/rendering/calm_water.h — the still's own ripples, taken out before new ones go in.
#pragma once

#include <opencv2/core.hpp>

#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// Water as a long exposure shows it. Ripples shift what is mirrored along the picture's columns, by less the farther
/// off they are: so each place takes the mean of its column's water, by a Gaussian whose deviation is `calm` times how
/// far below the horizon it lies. Upright things stay as sharp as they are, level ones soften as much.
/// colour    CV_32FC3, straight; alpha   CV_32F, 0..1: what is not water counts as little; of one size.
/// calm      0..0.2; 0: as it is.
/// Returns   a picture of its own. Above the horizon, and where there is no water, as it is.
/// Cost      six deviations of samples a pixel of water. All threads; the same for any number.
/// Source    our own: Chuang et al. 2005, Sec. 5, leaves open how existing ripples are taken out.
cv::Mat calmed(const cv::Mat& colour, const cv::Mat& alpha, const Line& horizon, double calm);

}  // namespace freshet::synth::scene
