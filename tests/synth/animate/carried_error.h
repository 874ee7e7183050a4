// tests/synth/animate/carried_error.h — whether the motion that is written leads from frame to frame.
#pragma once

#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {

/// How far frames are from the next ones when their motion carries them, a share of how far they are as they stand:
/// sums over all steps, over `where`.
/// frames   CV_8UC3. motions   one a frame, CV_32FC2, px.
inline double carried_error(const std::vector<cv::Mat>& frames, const std::vector<cv::Mat>& motions,
                            const cv::Mat& where) {
  double carried = 0, stood = 0;
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    cv::Mat to(where.size(), CV_32FC2), next;
    for (int y = 0; y < to.rows; ++y)
      for (int x = 0; x < to.cols; ++x)
        to.at<cv::Vec2f>(y, x) =
            cv::Vec2f(static_cast<float>(x), static_cast<float>(y)) + motions[i].at<cv::Vec2f>(y, x);
    cv::remap(frames[i + 1], next, to, {}, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    carried += cv::norm(next, frames[i], cv::NORM_L2SQR, where);
    stood += cv::norm(frames[i + 1], frames[i], cv::NORM_L2SQR, where);
  }
  return carried / stood;
}

}  // namespace freshet::synth::animate
