// hints/field_drawing.h — a picture with arrows that show where its fluid goes.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "hints/strokes.h"

namespace freshet::hints {

/// The picture, dimmed where the matte is black, under arrows every 1/26 of its longer side (24 px at least).
///
/// Hue is the direction, as in an orientation map, but lighter. Length is the speed, when there is one: the
/// longest for the 95th percentile and above; all are equal otherwise. A dark outline makes arrows readable
/// on anything. Where only a speed is asked there are discs, by its size. Strokes are drawn white, with a
/// head at their end.
///
/// direction   CV_32FC2, (0, 0) where there is none; or empty.
/// speed       CV_32F px/s, negative where there is none; or empty.
/// matte       CV_8U.
/// Returns     CV_8UC3 of the picture's size.
cv::Mat draw_field(const cv::Mat& picture, const cv::Mat& matte, const cv::Mat& direction,
                   const cv::Mat& speed, const std::vector<Stroke>& strokes = {});

}  // namespace freshet::hints
