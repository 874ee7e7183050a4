// synth/animate/placement/piece_values.h — a value of each piece on their lattice, and over the canvas.
#pragma once

#include <opencv2/core.hpp>

#include "synth/animate/placement/placement.h"

namespace freshet::synth::animate {

/// The lattice of the placement's pieces: where each of them lies there, and which places have one.
class PieceValues {
 public:
  explicit PieceValues(const Placement& placement);

  /// A value for each place of the lattice, CV_32F, of 0.
  cv::Mat none() const { return cv::Mat::zeros(present_.size(), CV_32F); }
  /// Where a patch's piece lies on the lattice.
  cv::Point at(std::size_t patch) const { return at_[patch]; }
  /// Values as a normalised Gaussian mean over neighbouring pieces, brought back to the canvas's pixels: CV_32F.
  /// reach    its sigma, pieces.
  cv::Mat over_canvas(const cv::Mat& values, double reach) const;

 private:
  int side_, stride_;
  cv::Size canvas_;
  std::vector<cv::Point> at_;
  cv::Mat present_;  // 1 where a piece lies
};

}  // namespace freshet::synth::animate
