// query/search/picture_scale.h — large pictures reduced before they are cut into pieces.
#pragma once

#include <opencv2/core.hpp>

#include "query/search/motion_guide.h"

namespace freshet::query {

/// How many pieces of `patch` px fit into a picture decides what it shows. At 1:1 a piece of a picture of
/// 3840 px holds a ripple where one of 1280 px holds a wave, and there are nine times as many. So a large
/// picture is reduced by the piece scale for search and labelling, and what is found is enlarged by it.
/// A piece scale is 1 to kMaxPieceScale.
inline constexpr double kMaxPieceScale = 16;

/// The scale that brings the longer side nearest to 1280 px in steps of a half: 1 up to 1599 px, 1.5 for
/// 1920, 2 for 2560, 3 for 3840. Most clips measure 1280 px: a patch then covers as much of the picture as of
/// its clip.
double auto_piece_scale(cv::Size picture);

/// The size of the picture that is searched: px, rounded, at least 1.
/// Throws Error{kUsage} for a scale below 1.
cv::Size reduced_size(cv::Size picture, double scale);

/// A picture or matte of reduced_size, by averages of areas; at scale 1 the same one, not copied.
cv::Mat reduce(const cv::Mat& picture, double scale);

/// What is asked of the reduced picture's motion: speeds are in px of the picture per second, and so less by
/// the scale. Directions keep; what is asked nowhere in a pixel's area is not asked there.
MotionGuide reduce(const MotionGuide& guide, double scale);

}  // namespace freshet::query
