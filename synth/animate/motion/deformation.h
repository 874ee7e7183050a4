// synth/animate/motion/deformation.h — what a flow does to forms that go along with it.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// By how much forms are drawn out or squeezed: the largest absolute principal strain rate, 1/s, of a flow that is
/// sampled every `step` px. Turning about and going along strain nothing.
/// motion   CV_32FC2, px/s. Returns CV_32F of its size.
cv::Mat strain_rate(const cv::Mat& motion, double step);

/// How far directions turn about some point within the matte: 1 around a vortex, .8 in a half turn between two flows,
/// .64 where they pass each other, 0 where all goes one way. The greatest curl of their mean (a Gaussian, sigma a
/// twentieth of the longer side) beside that of a vortex, sqrt(pi / 2) / sigma.
/// directions   CV_32FC2, unit vectors or (0, 0); empty: 0. matte CV_32F of their size: counted where above 0.5.
double vortex(const cv::Mat& directions, const cv::Mat& matte);

}  // namespace freshet::synth::animate
