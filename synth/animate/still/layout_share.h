// synth/animate/still/layout_share.h — where a picture's layout stands, and where its forms go: by place and band.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/still/standing_layout.h"

namespace freshet::synth::animate {

/// Of each Laplacian level, how far the layout stands: 0, the picture goes with its forms, as seas and clouds do; 1,
/// its texture alone does, as in falls; between, both are seen.
class LayoutShare {
 public:
  /// The same everywhere, 0..1.
  explicit LayoutShare(double everywhere) : least_(everywhere), most_(everywhere), mean_(everywhere) {}
  /// by_level  CV_32F, 0..1, finest first; of one size, sampled in even squares of the picture.
  /// matte     CV_32F, the picture's size.
  LayoutShare(std::vector<cv::Mat> by_level, const cv::Mat& matte);

  /// Of the whole fluid. What is nowhere above a fiftieth is nowhere at all.
  bool stands_somewhere() const { return most_ > kTrace; }
  bool goes_somewhere() const { return least_ < 1 - kTrace; }
  double mean() const { return mean_; }
  /// All levels together, CV_32F of `size`. With maps alone.
  cv::Mat over_picture(cv::Size size) const;

  /// Mixes luma of both kinds: of each level w of what stands, the root of w of the texture over it and the root of
  /// 1 - w of what goes, brought to w and 1 - w of both powers over some 16 samples: around a still both are alike,
  /// later they are not. Of the low-pass rest w and 1 - w.
  /// laid    as lay_texture made it, of this layout.
  /// goes    CV_32F; changed in place. With maps alone.
  void mix(const cv::Mat& laid, const StandingLayout& layout, cv::Mat& goes) const;

 private:
  static constexpr double kTrace = 0.02;

  double least_, most_, mean_;
  std::vector<cv::Mat> by_level_;
};

}  // namespace freshet::synth::animate
