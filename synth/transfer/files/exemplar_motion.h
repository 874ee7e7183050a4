// synth/transfer/files/exemplar_motion.h — how a picture with alpha moved to the next.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::transfer {

/// Optical flow of what is seen over black, by vision/flow's TV-L1.
///
/// from, to  CV_8UC4, CV_16UC4 or CV_32FC4 (0..1), straight alpha; of one size, at least 16 x 16 px.
/// Returns   CV_32FC2, px, x right, y down: what lies at p in `from` lies at p + flow(p) in `to`.
/// Cost      .16 CPU seconds for 640 x 480.
cv::Mat motion_between(const cv::Mat& from, const cv::Mat& to);

}  // namespace freshet::synth::transfer
