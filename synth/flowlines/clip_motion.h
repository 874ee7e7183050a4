// synth/flowlines/clip_motion.h — how a clip moves as a whole: its mean flow, where it flows, and whether the camera
// does.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"

namespace freshet::synth::flowlines {

struct ClipMotion {
  cv::Mat mean;    // CV_32FC2, px a frame, x right, y down
  cv::Mat speed;   // CV_32F, px a frame: mean of the flow's length
  cv::Mat steady;  // CV_32F, 0..1: length of the mean flow by the mean of its length; 1: always the same way
  cv::Mat matte;   // CV_8U, 255 where it flows
  /// What stands still moves so far from a frame to the next, px: mean and largest. A camera on a tripod has less than
  /// .1. Of a picture without anything that stands still: 0.
  double camera_px = 0, camera_max_px = 0;
  /// Of the picture, the share that goes the same way as fast, steadily, and how fast, px a frame: where nothing stands
  /// still, a camera that pans.
  double alike_share = 0, alike_px = 0;
  double still_share = 0;      // of the picture
  std::vector<cv::Mat> flows;  // CV_32FC2, reduced by kFlowStep, frame i to i + 1: first guesses
  static constexpr int kFlowStep = 4;
};

struct MotionOptions {
  double min_speed = 0.15;   // px a frame: slower does not flow
  double min_share = 0.1;    // of the 95th percentile of mean speeds: slower does not flow beside it
  double min_steady = 0.25;  // below: it goes to and fro, and rides no line
  double min_area = 0.004;   // of the picture: smaller islands are left out
};

/// luma      CV_8U, two frames or more of one size, 16 x 16 px or more.
/// Throws    Error{kCancelled}.
/// Cost      a DIS flow a frame (vision/flow.h), on all threads; the same for any number of them.
ClipMotion measure_motion(const std::vector<cv::Mat>& luma, const MotionOptions& options = {},
                          const Job& job = {});

}  // namespace freshet::synth::flowlines
