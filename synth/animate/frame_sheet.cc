#include "synth/animate/frame_sheet.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {

FrameSheet::FrameSheet(const cv::Mat& picture, int frames, int shown, int width_px)
    : frames_(frames), shown_(std::min(shown, frames)), width_(std::min(width_px, picture.cols)) {
  cells_.push_back(reduced(picture));
}

cv::Mat FrameSheet::reduced(const cv::Mat& picture) const {
  const int height = std::max(1, static_cast<int>(std::lround(1.0 * picture.rows * width_ / picture.cols)));
  cv::Mat out;
  cv::resize(picture, out, {width_, height}, 0, 0, cv::INTER_AREA);
  return out;
}

void FrameSheet::add(const cv::Mat& frame) {
  const int next = static_cast<int>(cells_.size()) - 1;
  if (next < shown_ && seen_ == next * frames_ / shown_) cells_.push_back(reduced(frame));
  ++seen_;
}

cv::Mat FrameSheet::draw() const {
  constexpr int kColumns = 3, kGap = 4;
  const int rows = (static_cast<int>(cells_.size()) + kColumns - 1) / kColumns;
  const cv::Size cell = cells_[0].size();
  cv::Mat sheet(rows * (cell.height + kGap) + kGap, kColumns * (cell.width + kGap) + kGap, CV_8UC3,
                cv::Scalar::all(32));
  for (int i = 0; i < static_cast<int>(cells_.size()); ++i) {
    const cv::Point corner(kGap + i % kColumns * (cell.width + kGap),
                           kGap + i / kColumns * (cell.height + kGap));
    cells_[i].copyTo(sheet(cv::Rect(corner, cell)));
  }
  return sheet;
}

}  // namespace freshet::synth::animate
