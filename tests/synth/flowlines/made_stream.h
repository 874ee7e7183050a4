// tests/synth/flowlines/made_stream.h — clips of a texture that flows down a channel at a known speed.
#pragma once

#include <functional>

#include <opencv2/core.hpp>

#include "synth/flowlines/footage.h"

namespace freshet::synth::flowlines {

struct MadeStream {
  cv::Size size{128, 96};
  int frames = 50;
  /// px a frame at a frame; the texture goes down with it, and where `sideways` is not 0 to the right as well.
  std::function<double(int frame)> speed = [](int) { return 3.0; };
  cv::Rect channel{32, 0, 64, 96};  // beyond it texture stands still
  double camera = 0;                // px a frame that what stands still goes to the right
  double flicker = 0;  // grey levels that all of it changes by from frame to frame, and no motion
};
Footage made_stream(const MadeStream& options = {});

}  // namespace freshet::synth::flowlines
