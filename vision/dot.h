// vision/dot.h — the sum of products of two matrices, the same on every processor.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::vision {

/// Of two CV_32F matrices of one size and any channels, in double: eight sums, each of every eighth value of a row,
/// and theirs. cv::Mat::dot adds in an order that depends on the processor's vectors: its last bit has changed a frame.
double dot(const cv::Mat& one, const cv::Mat& other);
/// dot(cv::abs(one), other), without the matrix between.
double dot_of_magnitudes(const cv::Mat& one, const cv::Mat& other);

}  // namespace freshet::vision
