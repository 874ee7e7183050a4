// synth/judging/recurrence.h — do the same forms come back? A fluid's do not.
#pragma once

#include <span>

#include <opencv2/core.hpp>

#include "synth/judging/evidence.h"
#include "synth/judging/reading.h"

namespace freshet::synth::judging {

inline constexpr int kRecurrenceWidth = 320;  // px; wider films are reduced to it: forms have a size
inline constexpr int kRecurrenceGap = 12;     // frames: nearer ones show the same forms, of course

/// Forms are luma less its mean over time (what stands is no form), band-passed to some 4 to 40 px. Mean over frames of
/// the correlation with the most alike frame at least kRecurrenceGap away; its map, of those two frames within each
/// cell.
/// luma   CV_8U, all of one size. matte CV_8U of it, counted where above 127.
/// NaN for fewer than kRecurrenceGap + 1 frames. Real footage: .2 (measures.md).
/// Cost   every frame against every other, at the reduced size. All threads; the same for any number.
Reading recurrence(std::span<const cv::Mat> luma, const cv::Mat& matte);
/// The same of a film that is judged.
Reading recurrence(const Evidence& film);

}  // namespace freshet::synth::judging
