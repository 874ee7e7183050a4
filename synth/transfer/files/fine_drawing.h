// synth/transfer/files/fine_drawing.h — threads, gaps and loose shreds of a design, given back to light.
#pragma once

#include "synth/transfer/transfer.h"

namespace freshet::synth::transfer {

/// How much brighter light is to be where a design draws finer than the search sees. Patches are chosen by the mask
/// as it is blurred: a thread of 3 px is the same to them as a smudge of 10, and loose shreds come out as dull spots
/// with round ends, gaps between tongues closed. The factor is the mask in parts of the blurred one, in gaps at least
/// what is seen through them. It acts where the blurred mask changes little within `radius` px; an outline of
/// something large stays the exemplar's, but for a fifth.
///
/// flow     px, as the mask has it: with motion_blur the factor is blurred along it as the frame is.
/// Returns  CV_32F, 0 to 2.5, 1 where nothing is lost.
/// Cost     O(radius) a px.
cv::Mat fine_drawing(const TargetFrame& target, const TransferOptions& options);

/// light    CV_32FC4 straight, alpha its brightest channel, as light_alone() makes it; alpha stays below 1. In place.
void draw_light(const cv::Mat& drawing, cv::Mat& light);

}  // namespace freshet::synth::transfer
