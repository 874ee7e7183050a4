// synth/outline/dynamic_matte.h — a matte carried along by the fluid it covers.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::outline {

struct DynamicMatteOptions {
  double tau = 0.95;  // 0..1: fraction of the moved matte that is kept each 1/25 s; 0: the matte stands still
  /// Fluid stays where it enters: at the foot of a flame, the mouth of a chimney. The paper has no such rule,
  /// and a flame that goes 4 px per frame leaves its logs by frame 50.
  bool held_foot = true;
  bool keep_softness = true;  // edges stay as soft as the still matte's; else they spread along the motion
};

/// B(i+1) = tau W_i(B_i) + (1 - tau) alpha, with B_0 = alpha, and its area kept in every frame.
///
/// The area is the sum of all pixels. It is kept by a shift of the logit of B, which leaves 0 and 1 where
/// they are: fluid appears only beside fluid. Edges are then sharpened, by a factor on the logit, until they
/// are as soft as alpha's, sum B (1 - B) the same. Both make the matte that is shown; the recursion goes on
/// with B as it was. When it was fed back, a shift a frame added up, and holes in the flames wandered through
/// them for seconds.
///
/// Source  Okabe et al. 2011, Sec. 6, "Dynamic Boundaries of Fluid" (their adjustment is not described, and
///         made each time B is computed); the warp is semi-Lagrangian, Stam 1999.
class DynamicMatte {
 public:
  /// alpha        CV_32F, 0..1.
  /// mean_motion  CV_32FC2, px/s, alpha's size: decides where fluid enters.
  /// Throws       Error{kUsage} for a tau outside 0..1 or fps not above 0.
  DynamicMatte(const cv::Mat& alpha, const cv::Mat& mean_motion, double fps,
               const DynamicMatteOptions& options = {});

  /// Moves on by one frame. All threads; the same for any number of them.
  /// motion   CV_32FC2, px/s, finite.
  void step(const cv::Mat& motion);

  /// The matte of the present frame: CV_32F, 0..1. Its area differs from alpha's by at most a thousandth,
  /// unless the motion has left too little fluid in the picture: then it is what can be had.
  const cv::Mat& matte() const { return shown_; }
  double area() const { return area_; }  // of alpha, px

 private:
  cv::Mat alpha_, keep_;  // keep_: tau by pixel
  cv::Mat state_, moved_, shown_;
  double fps_, area_ = 0, softness_ = 0;
  bool keep_softness_;
};

}  // namespace freshet::synth::outline
