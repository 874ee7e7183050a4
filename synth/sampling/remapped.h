// synth/sampling/remapped.h — a plane read between its samples.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::sampling {

/// What lies beyond a plane's edges.
enum class Beyond { kEdge, kZero };

/// What cv::remap (INTER_LINEAR) reads of a plane, to the bit: places are rounded to 1/32 of a sample.
/// plane    CV_32F of 1, 2 or 4 channels, less than 32768 samples wide and high.
/// places   CV_32FC2, of x and y. out: as large, of the plane's type; may be none of the others. Safe from many
///          threads.
void read_remapped(const cv::Mat& plane, const cv::Mat& places, Beyond beyond, cv::Mat& out);

}  // namespace freshet::synth::sampling
