// synth/judging/verdict_sheet.h — where a film is worst, on one page.
#pragma once

#include <opencv2/core.hpp>

#include "synth/judging/critic.h"
#include "synth/judging/evidence.h"

namespace freshet::synth::judging {

/// The still, then for each of the gravest findings (at most five) the frame in the middle of the span where it is
/// worst, cells tinted red as the measure reads above what is usual, the worst one framed; a line below each. CV_8UC3.
/// Frames are those of the evidence.
cv::Mat verdict_sheet(const Verdict& verdict, const Evidence& film);

}  // namespace freshet::synth::judging
