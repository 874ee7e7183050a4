// synth/scene/rendering/glitter_glow.h — the light that glittering water throws on what is around it.
#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "synth/scene/rendering/composite.h"

namespace freshet::synth::scene {

/// Glints come and go, and their light plays on hulls, walls and boughs beside the water. Of each frame the light of
/// the glints about a place is compared with that of the still, which shows the place as its own glints light it. Where
/// as much more falls as the still's brightest place has, all is brighter by `glow`, in the glints' mean colour.
///
/// A glint is what of the water's luma exceeds the still's mean by more than its deviation. Its light falls off as a
/// Gaussian, to a half at the reach.
class GlitterGlow {
 public:
  static constexpr double kUsualReach = 0.03;  // of the picture's longer side: further, it evens out

  /// still   the water alone as it was cut, CV_32FC4 of the picture's size, colours times alpha.
  GlitterGlow(double glow, std::optional<double> reach_px, const cv::Mat& still);
  GlitterGlow(const GlitterGlow&) = delete;
  GlitterGlow& operator=(const GlitterGlow&) = delete;

  /// The water alone in a frame, as `still`. Cost: a pass over the picture, and one to write the light.
  void see(const cv::Mat& water);

  /// What falls on other layers in that frame; valid as long as this is.
  const FallingLight& light() const { return light_; }

 private:
  /// Light of the glints about each cell.
  void gather(const cv::Mat& water, cv::Mat& out);

  double sigma_cells_;
  cv::Size cells_;
  float threshold_ = 0;
  double brightest_ = 0;  // of still_; 0: it has no glints
  cv::Mat glints_, still_, now_;
  cv::Mat falloff_;  // CV_32F, of the picture
  FallingLight light_;
};

}  // namespace freshet::synth::scene
