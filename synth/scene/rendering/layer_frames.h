// synth/scene/rendering/layer_frames.h — layers that bring frames of their own.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::scene {

/// Frames of a layer, one after the other: patches, transferred looks, footage.
class LayerFrames {
 public:
  virtual ~LayerFrames() = default;
  /// The next frame: CV_32FC4, sRGB code times alpha, and alpha, 0..1; empty where nothing of the layer is to be seen;
  /// valid until the next call. Errors are thrown as whoever makes the frames names them.
  virtual const cv::Mat& next() = 0;
  /// Where its upper left corner lies, px of the picture.
  virtual cv::Point at() const = 0;
};

}  // namespace freshet::synth::scene
