// synth/transfer/files/exemplar_motion.h — how a picture with alpha moved to the next.
#pragma once

#include <array>

#include <opencv2/core.hpp>

namespace freshet::synth::transfer {

/// What optical flow is taken of: luma over black, or over white where `from` is dark and has an alpha, because dark
/// smoke is not seen over black.
///
/// from, to  CV_8UC4, CV_16UC4 or CV_32FC4 (0..1), straight alpha; of one size.
/// is_light  taken off black: over black, however dim.
/// Returns   CV_8U, both over the same; of their size, but at least 16 px a side: edges repeated right and below.
std::array<cv::Mat, 2> seen_by_flow(const cv::Mat& from, const cv::Mat& to, bool is_light = false);

/// Optical flow of what is seen, by vision/flow's TV-L1.
///
/// from, to, is_light  as above.
/// Returns   CV_32FC2, px, x right, y down: what lies at p in `from` lies at p + flow(p) in `to`.
/// Cost      .16 CPU seconds for 640 x 480.
cv::Mat motion_between(const cv::Mat& from, const cv::Mat& to, bool is_light = false);

}  // namespace freshet::synth::transfer
