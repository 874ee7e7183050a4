#include "vision/sift_points.h"

#include <algorithm>
#include <cstring>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/features2d.hpp>

#include "freshet/error.h"

namespace freshet::vision {
namespace {

constexpr float kBin = 4;  // px
// cv::SIFT makes a bin 1.5 key point sizes wide.
constexpr float kKeyPointSize = kBin / 1.5f;
// A descriptor reaches ceil(4 * 5 / sqrt 2) = 15 px and a pixel more for gradients; its blur (sigma 1.6,
// kernel of 13) another 6. What lies farther cannot change it, so strips give the very bytes of the whole
// frame.
constexpr int kMargin = 24;
constexpr int kRowsPerStrip = 24;

// Row `y` of the frame's 2 x 2 means: value x stands at the corner shared by the pixels x - 1 and x.
void corner_row(const cv::Mat& frame, int y, const std::vector<int>& column, std::uint8_t* out) {
  const auto* above = frame.ptr<std::uint8_t>(cv::borderInterpolate(y - 1, frame.rows, cv::BORDER_REFLECT));
  const auto* below = frame.ptr<std::uint8_t>(cv::borderInterpolate(y, frame.rows, cv::BORDER_REFLECT));
  int left = above[column[0]] + below[column[0]];
  for (std::size_t x = 1; x < column.size(); ++x) {
    const int right = above[column[x]] + below[column[x]];
    out[x - 1] = static_cast<std::uint8_t>((left + right + 2) / 4);
    left = right;
  }
}

}  // namespace

std::vector<Descriptor> sift_points(const cv::Mat& frame, cv::Point origin, int columns, int rows, int pitch,
                                    std::span<const std::uint32_t> points) {
  const auto grid_points = static_cast<std::size_t>(std::max(columns, 0)) * std::max(rows, 0);
  if (frame.type() != CV_8UC1 || frame.empty() || columns < 0 || rows < 0 || pitch < 1 ||
      (!points.empty() && points.back() >= grid_points)) {
    throw Error(ErrorKind::kUsage, "dense SIFT",
                "an 8-bit plane, a grid and a pitch of at least 1 px expected");
  }
  std::vector<Descriptor> values(points.size());
  if (values.empty()) return values;

  // Strips are as wide as the grid: filters treat the last columns of a row apart, so all strips must end
  // alike.
  const int width = (columns - 1) * pitch + 1 + 2 * kMargin;
  std::vector<int> column(static_cast<std::size_t>(width) +
                          1);  // of the frame; one more, to the left, for the mean
  for (int x = 0; x <= width; ++x) {
    column[x] = cv::borderInterpolate(origin.x - kMargin + x - 1, frame.cols, cv::BORDER_REFLECT);
  }

  const auto strip = [&](int first_row, int row_count) {
    const auto in_strip = [&](int row) {
      const auto first = static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(columns);
      return static_cast<std::size_t>(std::lower_bound(points.begin(), points.end(), first) - points.begin());
    };
    const std::size_t first = in_strip(first_row), count = in_strip(first_row + row_count) - first;
    if (count == 0) return;
    cv::Mat corners((row_count - 1) * pitch + 1 + 2 * kMargin, width, CV_8U);
    const int top = origin.y + first_row * pitch - kMargin;
    for (int y = 0; y < corners.rows; ++y) corner_row(frame, top + y, column, corners.ptr<std::uint8_t>(y));

    std::vector<cv::KeyPoint> keys;
    keys.reserve(count);
    for (const std::uint32_t point : points.subspan(first, count)) {
      const int row = static_cast<int>(point) / columns - first_row, x = static_cast<int>(point) % columns;
      keys.emplace_back(static_cast<float>(kMargin + x * pitch), static_cast<float>(kMargin + row * pitch),
                        kKeyPointSize, 0.0f, 1.0f,
                        0);  // octave 0, layer 0: no enlarged picture, sigma 1.6
    }
    // One layer an octave: the layers above the first are built but never read.
    const auto sift = cv::SIFT::create(0, 1, 0.04, 10, 1.6, CV_8U);
    cv::Mat descriptors;
    try {
      sift->compute(corners, keys, descriptors);
    } catch (const cv::Exception& e) {
      throw Error(ErrorKind::kInput, "dense SIFT", "OpenCV refused the frame (" + e.err + ")");
    }
    if (keys.size() != count || descriptors.rows != static_cast<int>(count) ||
        descriptors.cols != kDescriptorSize || descriptors.type() != CV_8U) {
      throw Error(ErrorKind::kInput, "dense SIFT",
                  "OpenCV gave " + std::to_string(descriptors.rows) + " descriptors for " +
                      std::to_string(count) + " points");
    }
    for (std::size_t i = 0; i < count; ++i) {
      std::memcpy(values[first + i].data(), descriptors.ptr<std::uint8_t>(static_cast<int>(i)),
                  kDescriptorSize);
    }
  };

  const int strips = (rows + kRowsPerStrip - 1) / kRowsPerStrip;
  oneapi::tbb::parallel_for(
      0, strips, [&](int i) { strip(i * kRowsPerStrip, std::min(kRowsPerStrip, rows - i * kRowsPerStrip)); });
  return values;
}

}  // namespace freshet::vision
