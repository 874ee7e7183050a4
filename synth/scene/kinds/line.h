// synth/scene/kinds/line.h — a line drawn over the picture.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::scene {

/// px: (0, 0) is the outer corner of the picture's upper left pixel, whose middle is (0.5, 0.5).
struct Line {
  cv::Point2d from, to;

  bool operator==(const Line&) const = default;
};

}  // namespace freshet::synth::scene
