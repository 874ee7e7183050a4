// synth/animate/still/fluid_planes.h — a picture's luma and colour as its fluid has them, beyond the matte too.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// CV_32F, all of the picture's size.
struct FluidPlanes {
  cv::Mat luma, blue, red;  // blue and red less luma
  cv::Mat trusted;          // 0..1: how far a value is the picture's own, 1 from a matte of 1 / 8 on
};

/// What is not fluid takes the values that the fluid's would smoothly go on to (pull_push).
/// picture   CV_32FC3, BGR, 0..1; luma CV_32F, its luma_of; matte CV_32F, 0..1; all of one size.
FluidPlanes fluid_planes(const cv::Mat& picture, const cv::Mat& luma, const cv::Mat& matte);

}  // namespace freshet::synth::animate
