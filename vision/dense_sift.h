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

/// Descriptors of a frame at all points origin + (i * pitch, j * pitch), upright, bins of 4 px (16 px
/// windows).
///
/// A point (x, y) is the upper left CORNER of pixel (x, y), not its centre. The 9 points of a patch at x then
/// stand at both of its edges and evenly between, and the mirrored frame has its points at the mirror images
/// of these. With centres they would be a pixel apart, and a flipped patch could not share its twin's
/// descriptors.
struct DescriptorGrid {
  int columns = 0, rows = 0, pitch = 6;
  cv::Point origin;
  std::vector<Descriptor> values;  // row-major
};
/// frame    CV_8U. pitch px; 6 makes a 9 x 9 grid span a 48 px patch, and divides the stride of 24, so that
///          overlapping patches share descriptors. Near an edge the frame is continued by reflection.
///          Corners are made of 2 x 2 means; SIFT's own blur (sigma 1.6) follows.
/// origin   px, may be negative (a picture's pieces may overhang its edges).
/// Strips of the frame on all threads; same bytes for any number (with cv::setNumThreads(1), see flow.h).
/// Source   Okabe et al. 2011, Sec. 4; Lowe 2004 through cv::SIFT.
DescriptorGrid dense_sift(const cv::Mat& frame, cv::Point origin, int columns, int rows, int pitch = 6);

/// The descriptor that the mirrored picture has at the mirrored point (x of a corner becomes width - x): a
/// permutation of bins. Off by at most one unit in one bin (length 512), measured on noise.
Descriptor mirrored(const Descriptor& descriptor);

}  // namespace freshet::vision
