// synth/sampling/pull_push.h — pull-push: values continued beyond the region in which they are known.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::sampling {

/// values   CV_32F, 1 to 3 channels, finite everywhere.
/// weight   CV_32F, 0..1, same size: how far each value is to be trusted. Where it is 1 nothing changes.
/// Returns  values where they are trusted, and beyond a smooth continuation of the nearest trusted ones,
///          coarser with distance. All zero when no weight is above 0.
/// Cost     O(pixels).
/// Source   Gortler, Grzeszczuk, Szeliski, Cohen 1996, Sec. 3.4 (pull-push).
cv::Mat pull_push(const cv::Mat& values, const cv::Mat& weight);

}  // namespace freshet::synth::sampling
