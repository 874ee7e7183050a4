// synth/simulate/design/preview.h — what one instant of a design looks like.
#pragma once

#include <opencv2/core.hpp>

#include "synth/simulate/scene/design.h"

namespace freshet::synth::simulate {

/// The alpha of a density, and the fluid's light over a dark background with its obstacles.
/// density    of the picture. obstacles: how much of each pixel they cover.
/// alpha      CV_8U or CV_16U, overwritten; light: overwritten. All of one size.
void draw_preview(const Look& look, const Grid& density, const Grid& obstacles, cv::Mat& alpha,
                  GridOf<Rgb>& light);

}  // namespace freshet::synth::simulate
