// synth/judging/evidence.h — what a film is judged by: its frames as they go by, reduced, beside the still and the
// matte.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::judging {

inline constexpr int kJudgedSide =
    320;  // px, longer side; what is greater is reduced to it: forms have a size
inline constexpr int kJudgedFrames = 240;  // at most, from the first on
inline constexpr int kFewestFrames = 8;    // that say anything

/// Frames are kept: 0.23 MB each at 320 x 240. Cost: one area reduction a frame.
class Evidence {
 public:
  /// picture   CV_8UC3, the still, of the film's size. matte   CV_8U of it.
  /// side      px, longer side that all is reduced to.
  Evidence(const cv::Mat& picture, const cv::Mat& matte, double fps, int side = kJudgedSide);
  /// The next frame, CV_8UC3 of the still's size. Those beyond kJudgedFrames are passed over.
  void add(const cv::Mat& frame);

  const cv::Mat& still() const { return still_; }            // CV_8UC3
  const cv::Mat& still_luma() const { return still_luma_; }  // CV_8U
  const cv::Mat& matte() const { return matte_; }            // CV_8U
  const cv::Mat& fluid() const { return fluid_; }            // CV_8U: 255 where the matte is above 127
  const std::vector<cv::Mat>& frames() const { return frames_; }
  const std::vector<cv::Mat>& luma() const { return luma_; }
  int count() const { return static_cast<int>(luma_.size()); }
  double fps() const { return fps_; }
  cv::Size size() const { return still_.size(); }
  cv::Size picture() const { return picture_; }  // px, as it was given
  double seconds() const { return seconds_; }    // that reducing took

 private:
  cv::Size picture_;
  double fps_, seconds_ = 0;
  cv::Mat still_, still_luma_, matte_, fluid_;
  std::vector<cv::Mat> frames_, luma_;
};

}  // namespace freshet::synth::judging
