// synth/scene/rendering/layer_shadow.h — a layer's shadow moves as the layer does (Chuang et al. 2005, Sec. 5).
#pragma once

#include <opencv2/core.hpp>

#include "synth/scene/rendering/sprite.h"
#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// A layer that stands upright casts its alpha on the ground: its foot (the shadow line's first point) stays, its top
/// goes to the line's end, and what is beside it as far to the side. The shadow is blurred by its softness.
///
/// Where the still shows the shadow already, it is divided out where it was, and multiplied where it is: ground that it
/// leaves is as much brighter as the darkness says, and what does not move stays as the still has it.
class LayerShadow {
 public:
  /// layer    with a shadow line whose end lies higher or lower than its beginning, and that below the layer's top.
  /// alpha    CV_32F, of the layer in the still, of the picture's size; empty: it is not in the still.
  /// box      px, of the layer where it moves; else of all of the picture.
  LayerShadow(const SceneLayer& layer, const cv::Mat& alpha, const cv::Rect& box, cv::Size picture);

  /// Multiplies the light on what lies behind by what this leaves of it. alone   CV_32FC4, the layer as it is in
  /// the frame. light   CV_32F; both of the picture's size.
  void cast(const cv::Mat& alone, cv::Mat& light);

  /// px, in which light changes.
  const cv::Rect& region() const { return region_; }

 private:
  /// The shadow, 0..1, reduced. alpha   CV_32F, of source_.
  void lay(const cv::Mat& alpha, cv::Mat& shadow);

  double darkness_, softness_px_;
  int reduced_ = 1;
  cv::Rect source_, region_;  // px: what casts, and what is shaded
  cv::Size reduced_source_;
  cv::Matx23d source_from_region_;
  cv::Mat before_;  // CV_32F, reduced: the light that the still's shadow leaves; empty: it has none
  cv::Mat alpha_, smaller_, shadow_, whole_;
};

}  // namespace freshet::synth::scene
