// quality_asked.h — what a person asked for and can check by eye: it begins with the picture, keeps the
// direction, closes the loop, and does not show one patch everywhere.
#pragma once

#include <span>

#include <opencv2/core.hpp>

namespace freshet::bench {

/// Correlation of fine detail (luma less its blur, sigma 4 px) of a frame with the still's, inside the matte:
/// 1 where the animation begins as the picture is; 0 where either has no detail.
/// frame, still   CV_8U, luma. matte CV_8U, counted where above 127. All of one size.
double detail_correlation(const cv::Mat& frame, const cv::Mat& still, const cv::Mat& matte);

/// How a film goes against the direction that was asked. NaN where nothing was asked.
struct Reversals {
  double seconds = 0;  // in which the motion of all blocks together goes back by 0.25 px/s or more
  double blocks = 0;   // fraction of blocks and seconds that go back, of those that move at all
};
/// motion   by second, CV_32FC2, px/s: mean flow by blocks (Film::by_second).
/// asked    CV_32FC2, unit vectors or (0, 0), of the picture's size. matte CV_8U, its size.
Reversals reversals(std::span<const cv::Mat> motion, const cv::Mat& asked, const cv::Mat& matte);

/// Mean over phases of the SSIM of a frame with the one a period later, less the mean SSIM with frames of
/// other phases: how much there is that returns. 0 for a still; eight phases are compared.
/// luma     CV_8U. At least `period` frames; those beyond the last are those a period before: a film of one
///          period is taken to repeat exactly.
/// Source   MALF, of the evaluations of Holynski et al. 2021 and after.
double motion_after_loop(std::span<const cv::Mat> luma, int period, const cv::Mat& matte);

}  // namespace freshet::bench
