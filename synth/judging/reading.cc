#include "synth/judging/reading.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::judging {
namespace {

constexpr double kFluidCell = 0.25;  // of a cell, what must be fluid

}  // namespace

Worst worst_of(const Reading& reading) {
  Worst worst;
  for (std::size_t span = 0; span < reading.map.size(); ++span) {
    const cv::Mat& cells = reading.map[span];
    for (int y = 0; y < cells.rows; ++y)
      for (int x = 0; x < cells.cols; ++x) {
        const double value = cells.at<float>(y, x);
        if (std::isfinite(value) && (!worst.found || value > worst.value))
          worst = {true, {x, y}, static_cast<int>(span), value};
      }
  }
  return worst;
}

cv::Size cells_of(cv::Size picture) {
  const int longer = std::max(picture.width, picture.height);
  const auto along = [&](int side) {
    return std::clamp((kCells * side + longer / 2) / longer, 1, std::max(1, side));
  };
  return {along(picture.width), along(picture.height)};
}

cv::Mat cell_means(const cv::Mat& values, const cv::Mat& weight) {
  const cv::Size cells = cells_of(values.size());
  cv::Mat fluid, sum, mass;
  weight.convertTo(fluid, CV_32F, 1.0 / 255);
  cv::resize(values.mul(fluid), sum, cells, 0, 0, cv::INTER_AREA);
  cv::resize(fluid, mass, cells, 0, 0, cv::INTER_AREA);
  cv::Mat means = sum / cv::max(mass, 1e-6);
  means.setTo(std::numeric_limits<float>::quiet_NaN(), mass < kFluidCell);
  return means;
}

double mean_of(const cv::Mat& cells) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < cells.rows; ++y)
    for (int x = 0; x < cells.cols; ++x)
      if (const double value = cells.at<float>(y, x); std::isfinite(value)) {
        sum += value;
        ++count;
      }
  return count > 0 ? sum / count : kNotMeasured;
}

cv::Mat mean_of(std::span<const cv::Mat> maps) {
  if (maps.empty()) return {};
  cv::Mat means(maps.front().size(), CV_32F);
  for (int y = 0; y < means.rows; ++y)
    for (int x = 0; x < means.cols; ++x) {
      double sum = 0;
      int count = 0;
      for (const cv::Mat& map : maps)
        if (const double value = map.at<float>(y, x); std::isfinite(value)) {
          sum += value;
          ++count;
        }
      means.at<float>(y, x) =
          count > 0 ? static_cast<float>(sum / count) : std::numeric_limits<float>::quiet_NaN();
    }
  return means;
}

int span_of(int frame, int frames) { return std::min(kSpans - 1, frame * kSpans / std::max(1, frames)); }

}  // namespace freshet::synth::judging
