// tests/synth/transfer/made_exemplar.h — looks and designs whose truth is known.
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "synth/transfer/transfer.h"

namespace freshet::synth::transfer {

/// A blot on nothing, CV_8UC4: noise of two sizes, one half of it low in contrast, so that there is something
/// to wash out to; with a soft edge.
cv::Mat blot(cv::Size size, std::uint64_t seed);

/// A lobed disc in the middle of the frame that turns.
TargetFrame turning_disc(cv::Size size, int frame, double radians_per_frame = 0.03);

/// Mean square of the Laplacian of green where the frame is nearly opaque.
double laplacian_energy(const cv::Mat& bgra);

}  // namespace freshet::synth::transfer
