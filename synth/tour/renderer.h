// synth/tour/renderer.h — a frame as a camera elsewhere sees it.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "synth/tour/room.h"
#include "synth/tour/scenery.h"

namespace freshet::synth::tour {

/// Draws the planes, each by one homography, and over them what stands upright. Memory is allocated once.
class Renderer {
 public:
  /// Both outlive this.
  Renderer(const Room& room, const Scenery& scenery, cv::Size frame);

  /// out     CV_8UC3, or CV_32FC4 (sRGB code, alpha 1): of whichever type it is and the frame's size.
  /// depth   CV_32F, along the camera's axis, in heights of the picture's own camera above the floor; kFar: the sky.
  ///         Null: none. A thing's is its own where it covers half of a pixel.
  /// The same for any number of threads, over rows.
  void render(const Pinhole& camera, cv::Mat& out, cv::Mat* depth = nullptr) const;

 private:
  const Room& room_;
  const Scenery& scenery_;
  cv::Size frame_;
};

}  // namespace freshet::synth::tour
