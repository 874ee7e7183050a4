// synth/flowlines/files/line_drawing.h — flow lines drawn over their picture, to be looked at.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "synth/flowlines/lines/flow_line.h"

namespace freshet::synth::flowlines {

/// The picture dimmed where the matte is black, with the lines in the colours of their direction, and their names
/// where there is room. Beside it, where there are any, the edited lines over the picture: with a tick across for every
/// twelfth of the picture's height that particles of speed 1 would ride, so that ticks lie apart where they are fast;
/// positions of a line that moves are thinner, with their times. Returns CV_8UC3.
cv::Mat draw_lines(const cv::Mat& picture, const cv::Mat& matte, const std::vector<FlowLine>& lines,
                   const std::vector<FlowLine>& edited);

}  // namespace freshet::synth::flowlines
