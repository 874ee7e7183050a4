// synth/animate/forms/light_level.h — what shines, as light that adds up, and as the level that an eye sees.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// Light is linear, 1 is white; its level is the sRGB code of that, 0..1. Sums and mixtures are of light; thresholds,
/// distributions and likenesses are of levels. By tables, to 1e-4: 0.1 ms for 100,000 values.
float light_of(float level);
float level_of(float light);
/// CV_32F of any number of channels, value by value; below 0 and above 1 the ends count.
cv::Mat light_of(const cv::Mat& levels);
cv::Mat level_of(const cv::Mat& light);

/// Flames that die away go from their faint parts to their core, and do not turn glassy as a cross-fade's do: of a
/// level, what is above `gone` is left, stretched to the whole range. gone  0: all is there, to 1: nothing is.
inline float thinned(float level, float gone) {
  return level <= gone ? 0.0f : (level - gone) / (1 - gone + 1e-6f);
}

}  // namespace freshet::synth::animate
