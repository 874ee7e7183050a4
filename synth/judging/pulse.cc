#include "synth/judging/pulse.h"

#include <cmath>
#include <vector>

namespace freshet::synth::judging {
namespace {

/// About the line that fits best.
double deviation_about_trend(const std::vector<double>& values) {
  const double n = static_cast<double>(values.size()), middle = (n - 1) / 2;
  double mean = 0, across = 0, along = 0;
  for (double value : values) mean += value / n;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = static_cast<double>(i) - middle;
    across += t * (values[i] - mean);
    along += t * t;
  }
  const double slope = along > 0 ? across / along : 0;
  double spread = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double away = values[i] - mean - slope * (static_cast<double>(i) - middle);
    spread += away * away / n;
  }
  return std::sqrt(spread);
}

}  // namespace

Reading pulse(const Evidence& film) {
  std::vector<cv::Mat> cells;
  std::vector<double> levels;
  for (const cv::Mat& luma : film.luma()) {
    cv::Mat values;
    luma.convertTo(values, CV_32F);
    cells.push_back(cell_means(values, film.matte()));
    levels.push_back(cv::mean(luma, film.fluid())[0]);
  }
  Reading reading{.value = deviation_about_trend(levels), .map = {}};
  cv::Mat map(cells.front().size(), CV_32F);
  std::vector<double> series(cells.size());
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x) {
      for (std::size_t i = 0; i < cells.size(); ++i) series[i] = cells[i].at<float>(y, x);
      map.at<float>(y, x) = static_cast<float>(deviation_about_trend(series));
    }
  reading.map.push_back(map);
  return reading;
}

}  // namespace freshet::synth::judging
