#include "synth/sampling/cells.h"

namespace freshet::synth::sampling {

std::vector<cv::Rect> cells_touched(std::span<const cv::Rect> rects, const cv::Rect& within, cv::Size cell) {
  const int columns = (within.width + cell.width - 1) / cell.width,
            rows = (within.height + cell.height - 1) / cell.height;
  cv::Mat touched = cv::Mat::zeros(rows, columns, CV_8U);
  for (const cv::Rect& rect : rects) {
    const cv::Rect inside = (rect & within) - within.tl();
    if (inside.empty()) continue;
    touched(cv::Rect(cv::Point(inside.x / cell.width, inside.y / cell.height),
                     cv::Point((inside.br().x - 1) / cell.width + 1, (inside.br().y - 1) / cell.height + 1)))
        .setTo(1);
  }
  std::vector<cv::Rect> cells;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      if (touched.at<std::uint8_t>(row, column))
        cells.push_back(
            cv::Rect(within.x + column * cell.width, within.y + row * cell.height, cell.width, cell.height) &
            within);
  return cells;
}

}  // namespace freshet::synth::sampling
