// synth/animate/frame_sheet.h — an animation on one page: the picture, then frames evenly spread over it.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// Collects frames as they are rendered and lays them out in a grid.
class FrameSheet {
 public:
  /// frames   of the animation.
  /// shown    how many of them the sheet shows, beside the picture itself.
  FrameSheet(const cv::Mat& picture, int frames, int shown = 8, int width_px = 480);
  void add(const cv::Mat& frame);  // in order; CV_8UC3
  /// CV_8UC3, three columns.
  cv::Mat draw() const;

 private:
  cv::Mat reduced(const cv::Mat& picture) const;
  int frames_ = 0, shown_ = 0, width_ = 0, seen_ = 0;
  std::vector<cv::Mat> cells_;
};

}  // namespace freshet::synth::animate
