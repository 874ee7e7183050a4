// synth/scene/rendering/layer_glow.h — a fire's light on what is around it.
#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "synth/scene/rendering/composite.h"

namespace freshet::synth::scene {

/// The light of a film of fire, whose changes fall on the layers around it: the still shows those as the fire of the
/// first frame with any light lights them, level 1. Where it stands, they grow brighter by `glow` times what the level
/// exceeds 1, or darker; by half as much at its reach, as 1 / (1 + (distance / reach)^2). It has the fire's mean colour
/// at level 1, its strongest channel 1.
class LayerGlow {
 public:
  /// glow   0 or more. reach_px   nothing: a fifth of the picture's longer side.
  LayerGlow(double glow, std::optional<double> reach_px, cv::Size picture);
  LayerGlow(const LayerGlow&) = delete;
  LayerGlow& operator=(const LayerGlow&) = delete;

  /// The layer's frame, CV_32FC4, colours times alpha, or empty; its upper left corner at `at`. The first that has any
  /// light says where the fire is. Cost: a pass over the frame; once, one over the picture.
  void see(const cv::Mat& frame, cv::Point at);

  /// What falls on other layers in that frame; valid as long as this is.
  const FallingLight& light() const { return light_; }

 private:
  double glow_, reach_px_;
  cv::Mat falloff_;   // CV_32F, of the picture
  double whole_ = 0;  // light of level 1; 0: none was seen yet
  cv::Scalar colour_;
  FallingLight light_;
};

}  // namespace freshet::synth::scene
