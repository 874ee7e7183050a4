#include "synth/flowlines/jumps/fading.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::flowlines {
namespace {

constexpr float kLeastPace = 0.5f;  // grey levels a frame

float apart(const cv::Vec3b& a, const cv::Vec3b& b) {
  return static_cast<float>(std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2])) / 3;
}

/// The first pixel of a cell.
int begin_of(int cell, int cells, int pixels) { return (cell * pixels + cells - 1) / cells; }

/// Mean over a cell's pixels of what two frames differ by.
float apart(const cv::Mat& a, const cv::Mat& b, cv::Point cell, cv::Size cells) {
  const int x0 = begin_of(cell.x, cells.width, a.cols), x1 = begin_of(cell.x + 1, cells.width, a.cols);
  const int y0 = begin_of(cell.y, cells.height, a.rows), y1 = begin_of(cell.y + 1, cells.height, a.rows);
  float sum = 0;
  for (int y = y0; y < y1; ++y) {
    const auto *of_a = a.ptr<cv::Vec3b>(y), *of_b = b.ptr<cv::Vec3b>(y);
    for (int x = x0; x < x1; ++x) sum += apart(of_a[x], of_b[x]);
  }
  return sum / static_cast<float>(std::max(1, (x1 - x0) * (y1 - y0)));
}

}  // namespace

Fading::Fading(const std::vector<cv::Mat>& frames, cv::Size cells)
    : frames_(&frames), cells_(cells), pace_(cells, CV_32F, cv::Scalar(0)) {
  tbb::parallel_for(0, cells.height, [&](int y) {
    for (int x = 0; x < cells.width; ++x) {
      float sum = 0;
      for (std::size_t t = 1; t < frames.size(); ++t) sum += apart(frames[t], frames[t - 1], {x, y}, cells);
      pace_.at<float>(y, x) = std::max(kLeastPace, sum / static_cast<float>(frames.size() - 1));
    }
  });
}

cv::Mat Fading::of(const cv::Rect& region, const cv::Mat& arrival, const cv::Mat& away,
                   const Jump& jump) const {
  cv::Mat out(region.size(), CV_32F);
  const auto last = static_cast<float>(frames_->size() - 1);
  const auto frame = [&](float at) -> const cv::Mat& {
    return (*frames_)[static_cast<std::size_t>(std::clamp(std::round(at), 0.0f, last))];
  };
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const cv::Point cell(region.x + x, region.y + y);
      const float over = arrival.at<float>(y, x);
      const float from = static_cast<float>(jump.leaves) + over, to = static_cast<float>(jump.enters) + over;
      const float differ = apart(frame(from), frame(to), cell, cells_);
      const float room =
          std::min({to, last - from, static_cast<float>(jump.most) - std::abs(away.at<float>(y, x))});
      out.at<float>(y, x) = std::min(static_cast<float>(kSlower) * differ / pace_.at<float>(cell), room);
    }
  cv::blur(out, out, cv::Size(3, 3));
  return cv::max(out, 1.0f);
}

}  // namespace freshet::synth::flowlines
