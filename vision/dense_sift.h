// vision/dense_sift.h — SIFT descriptors on a regular grid over a frame, shared by all patches of it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::vision {

inline constexpr int kDescriptorSize = 128;
inline constexpr int kGridSide = 9;  // descriptors on a patch's side
using Descriptor = std::array<std::uint8_t, kDescriptorSize>;

/// Descriptors of a frame at all points origin + (i * pitch, j * pitch), upright, bins of 4 px (16 px windows).
struct DescriptorGrid {
  int columns = 0, rows = 0, pitch = 6;
  cv::Point origin;
  std::vector<Descriptor> values;  // row-major
};
/// frame    CV_8U. pitch px; 6 makes a 9 x 9 grid span a 48 px patch, and divides the stride of 24, so that
///          overlapping patches share descriptors. Near an edge the frame is continued by reflection.
/// origin   px, may be negative (a picture's pieces may overhang its edges).
/// Source   Okabe et al. 2011, Sec. 4; Lowe 2004 through cv::SIFT.
DescriptorGrid dense_sift(const cv::Mat& frame, cv::Point origin, int columns, int rows, int pitch = 6);

/// The descriptor that the mirrored picture has at the mirrored point: a permutation of bins.
Descriptor mirrored(const Descriptor& descriptor);

}  // namespace freshet::vision
