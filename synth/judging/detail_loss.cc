#include "synth/judging/detail_loss.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "vision/pyramid.h"

namespace freshet::synth::judging {
namespace {

constexpr double kNoDetail = 1;  // grey levels

/// |Laplacian| of the two finest levels, by cell.
cv::Mat detail_by_cell(const cv::Mat& luma, const cv::Mat& matte) {
  cv::Mat values;
  luma.convertTo(values, CV_32F);
  std::vector<cv::Mat> bands;
  vision::laplacian_pyramid(values, vision::levels_within(luma.size(), 2), bands);
  cv::Mat detail = cv::Mat::zeros(luma.size(), CV_32F);
  for (std::size_t level = 0; level + 1 < bands.size(); ++level) {
    cv::Mat whole;
    cv::resize(cv::abs(bands[level]), whole, luma.size(), 0, 0, cv::INTER_LINEAR);
    detail += whole;
  }
  return cell_means(detail, matte);
}

/// Means over 3 x 3 cells, of those that are fluid.
cv::Mat around(const cv::Mat& cells) {
  const cv::Mat known = cells == cells;
  cv::Mat values = cells.clone(), weight, sum, mass;
  values.setTo(0, ~known);
  known.convertTo(weight, CV_32F, 1.0 / 255);
  cv::boxFilter(values, sum, CV_32F, {3, 3}, {-1, -1}, true, cv::BORDER_CONSTANT);
  cv::boxFilter(weight, mass, CV_32F, {3, 3}, {-1, -1}, true, cv::BORDER_CONSTANT);
  cv::Mat means = sum / cv::max(mass, 1e-6);
  means.setTo(std::numeric_limits<float>::quiet_NaN(), ~known);
  return means;
}

}  // namespace

Reading detail_loss(const Evidence& film) {
  const cv::Mat own = around(detail_by_cell(film.still_luma(), film.matte()));
  std::vector<cv::Mat> cells(film.luma().size());
  oneapi::tbb::parallel_for(std::size_t{0}, cells.size(),
                            [&](std::size_t i) { cells[i] = detail_by_cell(film.luma()[i], film.matte()); });
  std::vector<std::vector<cv::Mat>> spans(kSpans);
  for (std::size_t i = 0; i < cells.size(); ++i)
    spans[static_cast<std::size_t>(span_of(static_cast<int>(i), film.count()))].push_back(cells[i]);
  Reading reading;
  std::vector<double> lost;
  for (const auto& span : spans) {
    const cv::Mat shown = around(mean_of(span));
    cv::Mat octaves(own.size(), CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
    for (int y = 0; y < own.rows; ++y)
      for (int x = 0; x < own.cols; ++x)
        if (const double still = own.at<float>(y, x); still >= kNoDetail) {
          const double loss = std::log2(still / std::max(0.05, static_cast<double>(shown.at<float>(y, x))));
          octaves.at<float>(y, x) = static_cast<float>(loss);
          lost.push_back(std::max(0.0, loss));
        }
    reading.map.push_back(octaves);
  }
  if (lost.empty()) return {};
  reading.value = 0;
  for (double loss : lost) reading.value += loss / static_cast<double>(lost.size());
  return reading;
}

}  // namespace freshet::synth::judging
