// synth/judging/colour_drift.h — how far a film's colours, and its level, leave the still's.
#pragma once

#include <span>

#include <opencv2/core.hpp>

#include "synth/judging/evidence.h"
#include "synth/judging/reading.h"

namespace freshet::synth::judging {

/// Means over squares of a quarter of the longer side, inside the matte; the root mean square of their difference, of
/// the channel and the frame that are farthest. Grey levels.
/// frames   CV_8UC3 as the still. matte CV_8U, a weight. Without a map.
double colour_drift(std::span<const cv::Mat> frames, const cv::Mat& still, const cv::Mat& matte);
/// The same, with a map: of each span's mean colour, the channel that is farthest from the still's, by cell.
Reading colour_drift(const Evidence& film);

}  // namespace freshet::synth::judging
