// synth/flowlines/jumps/fading.h — how long each place takes to go over from one run to the next.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::flowlines {

/// How much slower places go over than the clip changes.
inline constexpr double kSlower = 1.5;

inline constexpr int kMostFade = 16;  // frames to either side of a jump

/// From one run to the next, in frames of the clip.
struct Jump {
  int leaves = 0;  // the frame in which the run that ends would have gone on at the line's beginning
  int enters = 0;  // the frame in which the next run begins there
  int most = 1;    // frames to either side of it until other jumps are near
};

/// A place that goes over changes no faster than the clip usually does there. Fluid that is new in every frame goes
/// over at once; what creeps, or stands but for the camera's trembling, fades for as long as runs and clip have
/// frames. Differences are taken from whole pixels and then averaged: of a reduced picture, gravel that lies half a
/// pixel further looks the same, and in the picture it is seen to start.
class Fading {
 public:
  /// frames   CV_8UC3, two or more; kept by reference. cells   size of the reduced picture that fades are given for.
  Fading(const std::vector<cv::Mat>& frames, cv::Size cells);

  /// region    of the cells.
  /// arrival   CV_32F, the region's size: frames from a front's entry until the place goes over.
  /// away      CV_32F, as arrival: of those, how far that is from the front.
  /// Returns   CV_32F, as arrival: frames to either side, 1 or more. Frames of the clip suffice for it, and other jumps
  ///           have the rest of jump.most.
  cv::Mat of(const cv::Rect& region, const cv::Mat& arrival, const cv::Mat& away, const Jump& jump) const;

 private:
  const std::vector<cv::Mat>* frames_;
  cv::Size cells_;
  cv::Mat pace_;  // CV_32F, by cell: grey levels that the clip changes by from frame to frame
};

}  // namespace freshet::synth::flowlines
