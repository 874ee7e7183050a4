#include "vision/patch_grid.h"

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"

namespace freshet::vision {

std::vector<cv::Point> patch_positions(cv::Size frame, const PatchGrid& grid, bool mirrored) {
  if (grid.patch < 1 || grid.stride < 1) {
    throw Error(ErrorKind::kUsage, "patch grid",
                "patch " + std::to_string(grid.patch) + " px, stride " + std::to_string(grid.stride) +
                    " px; both must be at least 1");
  }
  std::vector<cv::Point> positions;
  const int room_x = frame.width - grid.patch, room_y = frame.height - grid.patch;
  if (room_x < 0 || room_y < 0) return positions;
  const int columns = room_x / grid.stride + 1, rows = room_y / grid.stride + 1;
  // What the unmirrored grid leaves over on the right, the mirrored one leaves on the left.
  const int first_x = mirrored ? room_x % grid.stride : 0;
  positions.reserve(static_cast<std::size_t>(columns) * rows);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      positions.emplace_back(first_x + column * grid.stride, row * grid.stride);
    }
  }
  return positions;
}

std::vector<float> patch_coverage(const cv::Mat& mask, const std::vector<cv::Point>& positions, int patch) {
  if (mask.type() != CV_8UC1 || patch < 1) {
    throw Error(ErrorKind::kUsage, "patch coverage",
                "a mask of one 8-bit plane and a patch of at least 1 px expected");
  }
  cv::Mat set, sums;
  cv::threshold(mask, set, 0, 1, cv::THRESH_BINARY);
  cv::integral(set, sums, CV_32S);
  std::vector<float> coverage;
  coverage.reserve(positions.size());
  const cv::Rect frame(cv::Point(), mask.size());
  for (const cv::Point p : positions) {
    const cv::Rect box(p.x, p.y, patch, patch);
    if ((box & frame) != box) {
      throw Error(ErrorKind::kUsage, "patch coverage",
                  "a patch at (" + std::to_string(p.x) + ", " + std::to_string(p.y) +
                      ") does not lie inside the mask");
    }
    const int count = sums.at<int>(p.y + patch, p.x + patch) - sums.at<int>(p.y, p.x + patch) -
                      sums.at<int>(p.y + patch, p.x) + sums.at<int>(p.y, p.x);
    coverage.push_back(static_cast<float>(count) / (static_cast<float>(patch) * patch));
  }
  return coverage;
}

}  // namespace freshet::vision
