// vision/look/lab_colours.h — a still as looks at it work: its size, its colours in CIE Lab, and how frequent each is
// in the fluid and beside it.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::vision {

/// Reduced or enlarged to a longer side of 640 px.
cv::Size worked_size(cv::Size whole);
/// CV_8U of that size: 255 where the matte is above 127 in the mean.
cv::Mat worked_matte(const cv::Mat& matte);

/// CV_32FC3: L of 0..100. picture   CV_8UC3 BGR.
cv::Mat lab_of(const cv::Mat& picture);
cv::Mat gaussian(const cv::Mat& plane, double sigma);

/// Of CV_32F where CV_8U `where` is not 0; 0 where it is so nowhere.
float median(const cv::Mat& plane, const cv::Mat& where);
/// Of a normal distribution, from the median distance to the median; 2 more, as no fluid has one colour alone.
float robust_deviation(const cv::Mat& plane, float middle, const cv::Mat& where);

/// Log of how frequent each pixel's colour is beside the fluid (fading over 60 px), less that of how frequent in it;
/// 0 everywhere where all is fluid. CV_32F.
/// inside   CV_8U, not 0 in the fluid.
cv::Mat log_ratio_beside(const cv::Mat& lab, const cv::Mat& inside);

}  // namespace freshet::vision
