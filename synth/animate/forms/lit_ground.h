// synth/animate/forms/lit_ground.h — what flames shine on, brighter and darker with them.
#pragma once

#include <opencv2/core.hpp>

#include "synth/animate/forms/parted_still.h"

namespace freshet::synth::animate {

/// The ground near a fire follows the light that falls on it, which comes from all flames nearby; far from it, it
/// stands by day. In the dark, where nothing else lights it, all of it follows: wax below its flame, logs, a wall.
class LitGround {
 public:
  /// still     the darkest quarter of its ground tells night from day.
  /// usual     CV_32F, the level of the light at which the ground is as in the picture.
  /// reach     px, sigma of the light around a flame; as much of it again falls within five times that, so that
  ///           together it falls off about as the square of the distance.
  /// lighting  by day, how far the ground follows, of the light's own change, 0..1. In the dark it follows it all.
  LitGround(const PartedStill& still, const cv::Mat& usual, double reach, double lighting);

  /// How much brighter each place of the ground is below these flames: CV_32F, 1 where nothing has changed.
  /// level  CV_32F, of the picture's size. share  of the change, 0..1.
  cv::Mat brightening(const cv::Mat& level, float share) const;
  /// 1: nothing but fire lights the ground, to 0.
  double darkness() const { return darkness_; }

 private:
  cv::Mat nearby(const cv::Mat& level) const;
  cv::Mat falling(const cv::Mat& level) const;

  cv::Size size_, reduced_;
  double darkness_;
  double sigma_;  // px, reduced
  cv::Mat usual_,
      near_;  // CV_32F, reduced: the light that falls usually, and 0..1, how far a place follows it
};

}  // namespace freshet::synth::animate
