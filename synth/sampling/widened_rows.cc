#include "synth/sampling/widened_rows.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "platform/vectors.h"

namespace freshet::synth::sampling {
namespace {

FRESHET_WIDE void between(const float* from, const std::int32_t* first, const std::int32_t* next,
                          const float* fraction, int n, float* to) {
  for (int i = 0; i < n; ++i) to[i] = from[first[i]] * (1 - fraction[i]) + from[next[i]] * fraction[i];
}

}  // namespace

WidenedRows::WidenedRows(const cv::Mat& coarse, cv::Size size) : coarse_(coarse), size_(size) {
  if (coarse.cols >= size.width || coarse.rows >= size.height) {
    // Small planes, and several ways to go: left to OpenCV.
    cv::resize(coarse, coarse_, size, 0, 0, cv::INTER_LINEAR);
    ready_ = true;
    return;
  }
  const double scale_x = 1 / (static_cast<double>(size.width) / coarse.cols);
  scale_y_ = 1 / (static_cast<double>(size.height) / coarse.rows);
  for (int x = 0; x < size.width; ++x) {
    const auto at = static_cast<float>((x + 0.5) * scale_x - 0.5);
    const int before = static_cast<int>(std::floor(at));
    const bool inside = before >= 0 && before + 1 < coarse.cols;
    first_.push_back(std::clamp(before, 0, coarse.cols - 1));
    next_.push_back(std::min(first_.back() + 1, coarse.cols - 1));
    fraction_.push_back(inside ? at - static_cast<float>(before) : 0.0f);
  }
  for (auto& line : lines_) line.resize(static_cast<std::size_t>(size.width));
}

const float* WidenedRows::widened(int row) {
  row = std::clamp(row, 0, coarse_.rows - 1);
  auto& line = lines_[row % 2];
  if (held_[row % 2] != row) {
    between(coarse_.ptr<float>(row), first_.data(), next_.data(), fraction_.data(), size_.width, line.data());
    held_[row % 2] = row;
  }
  return line.data();
}

WidenedRows::Row WidenedRows::at(int y) {
  if (ready_) return {coarse_.ptr<float>(y), coarse_.ptr<float>(y), 1, 0};
  const auto at = static_cast<float>((y + 0.5) * scale_y_ - 0.5);
  const int before = static_cast<int>(std::floor(at));
  const float fraction = at - static_cast<float>(before);
  return {widened(before), widened(before + 1), 1 - fraction, fraction};
}

}  // namespace freshet::synth::sampling
