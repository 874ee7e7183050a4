// synth/animate/placement/retiming.h — how fast each patch plays.
#pragma once

#include <opencv2/core.hpp>

#include "synth/animate/placement/placement.h"

namespace freshet::synth::animate {

/// Sets every patch's speed to `factor` times what the map says at its piece's middle.
///
/// factor   > 0; 1: as filmed, 0.5: slow motion.
/// map      CV_8UC3 BGR of the picture's size, of which the luma counts, or empty. Black is 0.5, mid-grey
///          (128) 1, white 2, logarithmic between. A piece's factor is the mean over the square of one stride
///          at its middle, rounded to a quarter of an octave: neighbours on an even part of the map have the
///          same, and so stay in step.
/// Throws   Error{kUsage} for a factor outside 0.05..20, Error{kInput} for a map of another size.
void retime(Placement& placement, double factor, const cv::Mat& map, cv::Size picture);

}  // namespace freshet::synth::animate
