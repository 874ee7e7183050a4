// synth/transfer/motion_blur.h — a frame smeared along its motion.
#pragma once

#include "synth/transfer/pixel_grid.h"

namespace freshet::synth::transfer {

/// Line convolution along each pixel's flow (Sec. 4.5, Fig. 9) with a Gaussian that is cut at two standard
/// deviations, length * |flow| px from end to end. Paths are straight lines. The paper says "a direction and
/// length given by the motion field" and no more.
PixelGrid blurred_along(const PixelGrid& picture, const VectorGrid& flow, double length);

}  // namespace freshet::synth::transfer
