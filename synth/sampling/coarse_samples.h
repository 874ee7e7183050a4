// synth/sampling/coarse_samples.h — where the samples of a coarse field lie.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::sampling {

/// From pixels of a plane to samples of a field, for cv::warpAffine with WARP_INVERSE_MAP. A sample stands in the
/// middle of `step` px of the picture (sample 0 at (step - 1) / 2); a pixel of the plane is `scale` px of the picture
/// wide, and the plane's first one is `origin`, in its own px.
inline cv::Matx23d samples_from_pixels(int step, double scale = 1, cv::Point origin = {}) {
  const double unit = scale / step, shift = 0.5 * unit - 0.5;
  return {unit, 0, origin.x * unit + shift, 0, unit, origin.y * unit + shift};
}

}  // namespace freshet::synth::sampling
