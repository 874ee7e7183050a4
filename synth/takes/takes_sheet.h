// synth/takes/takes_sheet.h — all takes in step, and why each lost.
#pragma once

#include <opencv2/core.hpp>

#include "synth/takes/trial.h"

namespace freshet::synth::takes {

/// A row a take: five frames of the same moments, cropped to the fluid; below each its name, its faults, and why it
/// lost. CV_8UC3. The chosen one is framed.
cv::Mat takes_sheet(const Trial& trial);
/// A film's sheet with its takes below.
cv::Mat with_takes(const cv::Mat& sheet, const Trial& trial);

}  // namespace freshet::synth::takes
