// quality/prior/begun_transfer.h — a transfer whose first frame is a still.
#pragma once

#include <opencv2/core.hpp>

#include "synth/transfer/transfer.h"

namespace freshet::bench {

/// As if `transfer` had made the still as its frame 0, each patch from its own place. Its next frame is frame 1.
/// bgra     the exemplar, as synth::transfer::ExemplarFrame has it: the still.
/// flow     CV_32FC2, px, its size: what lies at p in the still lies at p + flow in frame 1.
/// options  those of `transfer`.
/// Throws   Error{kIo}: the folder for temporary files cannot be written to.
void begin_with_still(const cv::Mat& bgra, const cv::Mat& flow,
                      const synth::transfer::TransferOptions& options, synth::transfer::Transfer& transfer);

}  // namespace freshet::bench
