#include "vision/dense_sift.h"

#include <algorithm>
#include <numeric>

#include "vision/sift_points.h"

namespace freshet::vision {
namespace {

constexpr int kBinsPerSide = 4, kOrientations = 8;

}  // namespace

DescriptorGrid dense_sift(const cv::Mat& frame, cv::Point origin, int columns, int rows, int pitch) {
  DescriptorGrid grid{columns, rows, pitch, origin, {}};
  std::vector<std::uint32_t> all(static_cast<std::size_t>(std::max(columns, 0)) * std::max(rows, 0));
  std::iota(all.begin(), all.end(), 0u);
  grid.values = sift_points(frame, origin, columns, rows, pitch, all);
  return grid;
}

Descriptor mirrored(const Descriptor& descriptor) {
  // Bins are rows x columns x orientations, orientation k standing at 45 k degrees, counter-clockwise from
  // right: a mirror turns columns round, and an angle a into 180 degrees - a.
  Descriptor mirror;
  for (int row = 0; row < kBinsPerSide; ++row) {
    for (int column = 0; column < kBinsPerSide; ++column) {
      const int from = (row * kBinsPerSide + column) * kOrientations;
      const int to = (row * kBinsPerSide + kBinsPerSide - 1 - column) * kOrientations;
      for (int k = 0; k < kOrientations; ++k) {
        mirror[to + (kOrientations + kOrientations / 2 - k) % kOrientations] = descriptor[from + k];
      }
    }
  }
  return mirror;
}

}  // namespace freshet::vision
