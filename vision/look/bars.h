// vision/look/bars.h — black bars at a picture's sides, as films have that are wider or narrower than their frame.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::vision {

/// What lies within the bars: from a side inwards, rows or columns of one black, that end all along in a picture. A
/// dark sky, or the black around a flame, ends here and there, and is none.
/// picture   CV_8UC3 BGR.
/// Returns   px, some of it always; all of the picture where it has no bars.
/// Cost      one reading of the picture, reduced.
cv::Rect within_bars(const cv::Mat& picture);

/// A matte that holds all within the bars: CV_8U of the picture's size.
cv::Mat matte_within_bars(const cv::Mat& picture);

}  // namespace freshet::vision
