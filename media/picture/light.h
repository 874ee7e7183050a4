// media/picture/light.h — light and its sRGB code: what EXR files hold, and what all others do.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::media {

/// sRGB's curve (IEC 61966-2-1), which goes on above 1 as it does below, and is mirrored at 0: what is brighter
/// than white in a file of linear light is not lost.
float linear_of(float coded);
float coded_of(float linear);

/// CV_32FC3, each value through the curve.
cv::Mat to_linear(const cv::Mat& coded);
cv::Mat to_coded(const cv::Mat& linear);

}  // namespace freshet::media
