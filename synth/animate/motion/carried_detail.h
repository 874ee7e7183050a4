// synth/animate/motion/carried_detail.h — detail that comes anew and is carried on until it has died away.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// A field with a memory: each frame it is carried along the motion, fades by `kept`, and takes in what is new.
/// With innovations of variance s^2 in every frame it settles at s^2 / (1 - kept^2).
class CarriedDetail {
 public:
  /// canvas    px of the picture reduced by `scale`, on which the detail lies.
  /// kept      of the detail from one frame to the next, 0..1.
  CarriedDetail(const cv::Rect& canvas, double scale, double kept);

  /// Goes on to the next frame. displacement: the field's, from the frame before to this one.
  /// fresh     CV_32F, of the canvas. All threads. Returns the detail, to be read until the next call.
  const cv::Mat& advance(const cv::Mat& displacement, int step, const cv::Mat& fresh);

 private:
  cv::Rect canvas_;
  double scale_ = 1, kept_ = 0;
  cv::Mat detail_;
};

}  // namespace freshet::synth::animate
