// vision/sift_points.h — SIFT descriptors at some of the points of a dense grid.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "vision/dense_sift.h"

namespace freshet::vision {

/// The values that dense_sift(frame, origin, columns, rows, pitch) has at these points, byte for byte.
/// points   row * columns + column, ascending.
/// Cost     that of the points, and of blurring the strips of 24 rows in which any lies.
std::vector<Descriptor> sift_points(const cv::Mat& frame, cv::Point origin, int columns, int rows, int pitch,
                                    std::span<const std::uint32_t> points);

}  // namespace freshet::vision
