// synth/scene/rendering/layer_frames.h — layers that bring frames of their own.
#pragma once

#include <optional>

#include <opencv2/core.hpp>

namespace freshet::synth::scene {

/// What is asked of such a layer. Nothing is computed or kept for a motion that nobody asks for.
enum class FrameWork { kFrames, kFramesAndMotion };

/// Frames of a layer, one after the other: patches, transferred looks, footage.
class LayerFrames {
 public:
  virtual ~LayerFrames() = default;
  /// The next frame: CV_32FC4, sRGB code times alpha, and alpha, 0..1; empty where nothing of the layer is to be seen;
  /// valid until the next call. Errors are thrown as whoever makes the frames names them.
  virtual const cv::Mat& next() = 0;
  /// Where what the last frame shows goes until the next one: CV_32FC2 of that frame's size, px, x right, y down; empty
  /// where the frame is. Where two courses of the film are mixed, that of the one which is seen more. After the last
  /// frame of what plays once the motion goes on as it was. No value: it is not known. With
  /// FrameWork::kFramesAndMotion, after next(), once.
  virtual std::optional<cv::Mat> motion() = 0;
  /// Where its upper left corner lies, px of the picture.
  virtual cv::Point at() const = 0;
};

}  // namespace freshet::synth::scene
