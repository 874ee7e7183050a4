// synth/animate/placement/pieces_picture.h — the picture that pieces lie on.
#pragma once

#include <opencv2/core.hpp>

#include "synth/animate/placement/placement.h"

namespace freshet::synth::animate {

/// Its size, px, rounded, at least 1, where `picture` px are shown: reduced by Placement::piece_scale, which below 1
/// says that a small copy of the labelled picture is shown.
cv::Size pieces_picture(const Placement& placement, cv::Size picture);

}  // namespace freshet::synth::animate
