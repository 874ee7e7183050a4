// quality_recurrence.h — what a fluid does not do: show the same forms again, or change its colours.
#pragma once

#include <span>

#include <opencv2/core.hpp>

namespace freshet::bench {

inline constexpr int kRecurrenceWidth = 320;  // px; wider films are reduced to it: forms have a size
inline constexpr int kRecurrenceGap = 12;     // frames: nearer ones show the same forms, of course

/// Do the same forms come back? Forms are luma less its mean over time (what stands is no form), band-passed to some 4
/// to 40 px. Mean over frames of the correlation with the most alike frame at least kRecurrenceGap away.
/// luma   CV_8U, all of one size. matte CV_8U of it, counted where above 127.
/// NaN for fewer than kRecurrenceGap + 1 frames. Cost: every frame against every other, at the reduced size.
double comes_again(std::span<const cv::Mat> luma, const cv::Mat& matte);

/// How far a film's colours leave the still's: means over squares of a quarter of the longer side, inside the matte;
/// the root mean square of their difference, of the channel and the frame that are farthest. Grey levels.
/// frames   CV_8UC3 as the still. matte CV_8U, a weight.
double colour_drift(std::span<const cv::Mat> frames, const cv::Mat& still, const cv::Mat& matte);

}  // namespace freshet::bench
