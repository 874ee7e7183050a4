// synth/animate/frames/pieces_canvas.h — the picture as the pieces lie on it.
#pragma once

#include <opencv2/core.hpp>

#include "synth/animate/placement/placement.h"

namespace freshet::synth::animate {

/// canvas_of the pieces, on the picture reduced by their scale; it may go beyond the picture.
class PiecesCanvas {
 public:
  PiecesCanvas(const Placement& placement, cv::Size picture);

  const cv::Rect& rect() const { return rect_; }
  double scale() const { return scale_; }
  /// A plane of the picture's size, CV_32F, there; beyond the picture it is reflected. May be a part of the plane
  /// itself.
  cv::Mat cut(const cv::Mat& plane) const;
  /// A field that is sampled every `step` px of the picture, there; beyond its samples they go on.
  cv::Mat cut_samples(const cv::Mat& samples, int step) const;
  /// The other way round: a plane of the canvas at those samples, `size` of them; beyond the canvas it goes on.
  cv::Mat sampled(const cv::Mat& plane, int step, cv::Size size) const;

 private:
  cv::Rect rect_;
  double scale_ = 1;
  cv::Size reduced_;  // of the picture
};

}  // namespace freshet::synth::animate
