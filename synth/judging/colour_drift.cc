#include "synth/judging/colour_drift.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "vision/dot.h"

namespace freshet::synth::judging {
namespace {

constexpr int kColourCells = 4;  // along the longer side

/// CV_32FC3: weighted means of cells; `mass` their weights, CV_32F.
cv::Mat square_means(const cv::Mat& frame, const cv::Mat& weight, cv::Size cells, cv::Mat& mass) {
  cv::Mat colour, wide, means;
  frame.convertTo(colour, CV_32F);
  cv::merge(std::vector<cv::Mat>{weight, weight, weight}, wide);
  cv::resize(colour.mul(wide), means, cells, 0, 0, cv::INTER_AREA);
  cv::resize(weight, mass, cells, 0, 0, cv::INTER_AREA);
  cv::merge(std::vector<cv::Mat>{mass, mass, mass}, wide);
  return means / cv::max(wide, 1e-6);
}

}  // namespace

double colour_drift(std::span<const cv::Mat> frames, const cv::Mat& still, const cv::Mat& matte) {
  cv::Mat weight, mass;
  matte.convertTo(weight, CV_32F, 1.0 / 255);
  const int longer = std::max(still.cols, still.rows);
  const cv::Size cells(std::max(1, kColourCells * still.cols / longer),
                       std::max(1, kColourCells * still.rows / longer));
  const cv::Mat own = square_means(still, weight, cells, mass);
  const double all = std::max(cv::sum(mass)[0], 1e-6);
  std::vector<double> drift(frames.size());
  oneapi::tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t i) {
    cv::Mat same, away = square_means(frames[i], weight, cells, same) - own;
    std::vector<cv::Mat> channels;
    cv::split(away.mul(away), channels);
    for (const cv::Mat& squares : channels)
      drift[i] = std::max(drift[i], std::sqrt(vision::dot(squares, mass) / all));
  });
  return drift.empty() ? 0 : *std::max_element(drift.begin(), drift.end());
}

Reading colour_drift(const Evidence& film) {
  Reading reading{.value = colour_drift(film.frames(), film.still(), film.matte()), .map = {}};
  cv::Mat still;
  film.still().convertTo(still, CV_32F);
  std::vector<cv::Mat> sums(kSpans);
  std::vector<int> counts(kSpans);
  for (int i = 0; i < film.count(); ++i) {
    const auto span = static_cast<std::size_t>(span_of(i, film.count()));
    cv::Mat frame;
    film.frames()[static_cast<std::size_t>(i)].convertTo(frame, CV_32F);
    if (sums[span].empty()) sums[span] = cv::Mat::zeros(frame.size(), frame.type());
    sums[span] += frame;
    ++counts[span];
  }
  for (std::size_t span = 0; span < sums.size(); ++span) {
    if (counts[span] == 0) continue;
    std::vector<cv::Mat> channels;
    cv::split(sums[span] / counts[span] - still, channels);
    cv::Mat farthest;
    for (const cv::Mat& channel : channels) {
      const cv::Mat away = cv::abs(cell_means(channel, film.matte()));
      if (farthest.empty())
        farthest = away;
      else
        cv::max(farthest, away, farthest);
    }
    reading.map.push_back(farthest);
  }
  return reading;
}

}  // namespace freshet::synth::judging
