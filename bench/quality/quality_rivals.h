// quality_rivals.h — strong simple rivals: the still itself, carried by the clip's true motion.
#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::bench {

/// Two copies of the still, as Eulerian cinemagraphs blend them: one carried on from the first frame, one that
/// comes back to the still in the last, faded from the one into the other: both ends are the still. Where a
/// copy would bring what lies outside the picture the other is shown. Motion fades out with the matte, and
/// where that is 0 the frames are the still.
/// still   CV_8UC3. matte CV_8U.
/// flow    px of the still per frame, CV_32FC2 of any size (stretched to the still's): one field for all
///         frames, or one for each but the last.
/// Returns `frames` frames, CV_8UC3. All threads; the same for any number.
/// Memory  19 bytes per pixel and frame.
/// Source  Holynski et al. 2021, by backward maps in place of splatting.
std::vector<cv::Mat> carry_still(const cv::Mat& still, const cv::Mat& matte, std::span<const cv::Mat> flow,
                                 int frames);

}  // namespace freshet::bench
