// synth/animate/forms/handed_frame.h — a finished frame as whoever asked for it takes it.
#pragma once

#include <opencv2/core.hpp>

#include "synth/animate/frames/animation.h"

namespace freshet::synth::animate {

/// frame, picture  CV_32FC3, sRGB code: the picture with the fluid in it, and the picture. matte  CV_32F, 0..1.
/// Of the colour that lies below the matte: the frame's own is mixed with the picture by it.
cv::Mat handed_on(const cv::Mat& frame, const cv::Mat& picture, const cv::Mat& matte, FrameForm form);

}  // namespace freshet::synth::animate
