#include "synth/judging/seams.h"

#include <algorithm>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::judging {
namespace {

constexpr int kNear = 8;  // parts of the longer side

/// CV_8U: the greater of the steps to the next pixel right and below.
cv::Mat steps_of(const cv::Mat& luma) {
  cv::Mat steps = cv::Mat::zeros(luma.size(), CV_8U);
  if (luma.cols > 1) {
    cv::Mat part = steps.colRange(0, luma.cols - 1), across;
    cv::absdiff(luma.colRange(1, luma.cols), luma.colRange(0, luma.cols - 1), across);
    cv::max(part, across, part);
  }
  if (luma.rows > 1) {
    cv::Mat part = steps.rowRange(0, luma.rows - 1), down;
    cv::absdiff(luma.rowRange(1, luma.rows), luma.rowRange(0, luma.rows - 1), down);
    cv::max(part, down, part);
  }
  return steps;
}

}  // namespace

Reading seams(const Evidence& film) {
  const int reach = std::max(1, std::max(film.size().width, film.size().height) / kNear);
  cv::Mat limit;
  cv::dilate(steps_of(film.still_luma()), limit, cv::Mat::ones(2 * reach + 1, 2 * reach + 1, CV_8U));
  cv::add(limit, cv::Scalar(kSeamStep), limit);
  std::vector<cv::Mat> cells(film.luma().size());
  std::vector<double> shares(film.luma().size());
  oneapi::tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
    cv::Mat steep;
    cv::Mat(steps_of(film.luma()[i]) > limit).convertTo(steep, CV_32F, 1000.0 / 255);
    shares[i] = cv::mean(steep, film.fluid())[0];
    cells[i] = cell_means(steep, film.matte());
  });
  Reading reading{.value = 0, .map = {}};
  std::vector<std::vector<cv::Mat>> spans(kSpans);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    reading.value += shares[i] / static_cast<double>(shares.size());
    spans[static_cast<std::size_t>(span_of(static_cast<int>(i), film.count()))].push_back(cells[i]);
  }
  for (const auto& span : spans) reading.map.push_back(mean_of(span));
  return reading;
}

}  // namespace freshet::synth::judging
