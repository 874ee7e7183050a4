// vision/look/lies_at.h — what lies at a point of a picture's matte: what a click holds still, or lets go.
#pragma once

#include <span>

#include <opencv2/core.hpp>

namespace freshet::vision {

/// Of the matte: what a click takes, unless it is cut off before.
inline constexpr double kClickTakes = .02;

/// What a click takes: the pixels that are nearest to it along the picture, until they are a share of the matte. A step
/// costs more across edges, off the click's colour, and where colours are the fluid's rather than its surroundings'.
/// Beside the matte, and where it is held already, steps cost next to nothing: so the rim of one thing is taken all
/// around it. What is nearer to a click of the other kind is left. A click on what is held takes of that, to let it go.
///
/// picture       CV_8UC3 BGR. matte, held   CV_8U of its size: fluid, and what is held of it, above 127.
/// at            px, inside of the picture. others   clicks of the other kind before it.
/// takes         of the matte, above 0.
/// Returns       CV_8U of the picture's size, 255 where it lies, holes filled; all 0 where `at` is not in the matte.
/// Cost          docs/measurements/first_takes.md, "Clicks", which says too how much of what stands it finds. Worked at
///               640 px, on one core.
cv::Mat what_lies_at(const cv::Mat& picture, const cv::Mat& matte, const cv::Mat& held, cv::Point at,
                     std::span<const cv::Point> others, double takes = kClickTakes);

/// The point of an area that is farthest from what is not of it, the picture's sides too; of equals the uppermost.
/// area   CV_8U, not 0 somewhere.
cv::Point innermost(const cv::Mat& area);

}  // namespace freshet::vision
