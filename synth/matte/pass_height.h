// synth/matte/pass_height.h — how steep a picture is, at the least, on the way from marks to each pixel.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::matte {

/// |gradient| of a picture's smoothed Lab colours, CV_32F: levels of L, a and b (0..1, -1..1) a pixel.
/// picture  CV_8UC3.
cv::Mat steepness(const cv::Mat& picture);

/// Of all 4-connected paths from a seed to a pixel, the least of their greatest heights, the seed's own left out; 0 at
/// seeds. FLT_MAX everywhere without a seed.
/// relief   CV_32F, heights >= 0. seeds   CV_8U, its size, not 0 at seeds.
/// Cost     n log n; 25 ms for 77,000 pixels.
/// Source   the pass value of watershed cuts (Cousty et al. 2009).
cv::Mat pass_heights(const cv::Mat& relief, const cv::Mat& seeds);

}  // namespace freshet::synth::matte
