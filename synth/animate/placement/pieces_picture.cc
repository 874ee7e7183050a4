#include "synth/animate/placement/pieces_picture.h"

#include <algorithm>
#include <cmath>

namespace freshet::synth::animate {

cv::Size pieces_picture(const Placement& placement, cv::Size picture) {
  const auto reduced = [&](int side) {
    return std::max(1, static_cast<int>(std::lround(side / placement.piece_scale)));
  };
  return {reduced(picture.width), reduced(picture.height)};
}

}  // namespace freshet::synth::animate
