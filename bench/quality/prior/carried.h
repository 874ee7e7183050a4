// quality/prior/carried.h — what a frame shows, carried along a field.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace freshet::bench {

/// frame    any depth and channels. by: CV_32FC2, px, its size: what is shown at p lay at p - by.
/// border   cv::BorderTypes: what lies beyond the frame.
inline cv::Mat carried(const cv::Mat& frame, const cv::Mat& by, int border) {
  cv::Mat from(by.size(), CV_32FC2), out;
  for (int y = 0; y < by.rows; ++y)
    for (int x = 0; x < by.cols; ++x)
      from.at<cv::Vec2f>(y, x) =
          cv::Vec2f(static_cast<float>(x), static_cast<float>(y)) - by.at<cv::Vec2f>(y, x);
  cv::remap(frame, out, from, cv::noArray(), cv::INTER_LINEAR, border);
  return out;
}

}  // namespace freshet::bench
