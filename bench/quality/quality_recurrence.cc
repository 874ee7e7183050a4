#include "bench/quality/quality_recurrence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::bench {
namespace {

constexpr double kFinest = 1, kCoarsest = 10;  // sigmas of the band-pass, px
constexpr int kColourCells = 4;                // along the longer side

/// CV_32FC3: weighted means of cells; `mass` their weights, CV_32F.
cv::Mat cell_means(const cv::Mat& frame, const cv::Mat& weight, cv::Size cells, cv::Mat& mass) {
  cv::Mat colour, wide, means;
  frame.convertTo(colour, CV_32F);
  cv::merge(std::vector<cv::Mat>{weight, weight, weight}, wide);
  cv::resize(colour.mul(wide), means, cells, 0, 0, cv::INTER_AREA);
  cv::resize(weight, mass, cells, 0, 0, cv::INTER_AREA);
  cv::merge(std::vector<cv::Mat>{mass, mass, mass}, wide);
  return means / cv::max(wide, 1e-6);
}

}  // namespace

double comes_again(std::span<const cv::Mat> luma, const cv::Mat& matte) {
  const int frames = static_cast<int>(luma.size());
  if (frames <= kRecurrenceGap) return std::numeric_limits<double>::quiet_NaN();
  const cv::Size whole = luma.front().size();
  const int width = std::min(kRecurrenceWidth, whole.width);
  const cv::Size size(width, std::max(1, whole.height * width / whole.width));
  std::vector<cv::Mat> reduced(luma.size());
  cv::Mat mean = cv::Mat::zeros(size, CV_32F), inside;
  for (std::size_t i = 0; i < luma.size(); ++i) {
    cv::Mat small;
    cv::resize(luma[i], small, size, 0, 0, cv::INTER_AREA);
    small.convertTo(reduced[i], CV_32F);
    mean += reduced[i] / frames;
  }
  cv::resize(matte, inside, size, 0, 0, cv::INTER_LINEAR);
  const auto counted = static_cast<int>(cv::countNonZero(inside > 127));
  if (counted == 0) return std::numeric_limits<double>::quiet_NaN();
  cv::Mat forms(frames, counted, CV_32F);
  oneapi::tbb::parallel_for(0, frames, [&](int i) {
    const cv::Mat changed = reduced[static_cast<std::size_t>(i)] - mean;
    cv::Mat fine, coarse;
    cv::GaussianBlur(changed, fine, {}, kFinest);
    cv::GaussianBlur(changed, coarse, {}, kCoarsest);
    auto* to = forms.ptr<float>(i);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        if (inside.at<std::uint8_t>(y, x) > 127) *to++ = fine.at<float>(y, x) - coarse.at<float>(y, x);
    cv::Mat row = forms.row(i);
    row -= cv::mean(row)[0];
    row /= cv::norm(row) + 1e-6;
  });
  std::vector<double> most(luma.size());
  oneapi::tbb::parallel_for(0, frames, [&](int i) {
    double best = -1;
    for (int j = 0; j < frames; ++j)
      if (std::abs(i - j) >= kRecurrenceGap) best = std::max(best, forms.row(i).dot(forms.row(j)));
    most[static_cast<std::size_t>(i)] = best;
  });
  double sum = 0;
  for (double best : most) sum += best;
  return sum / frames;
}

double colour_drift(std::span<const cv::Mat> frames, const cv::Mat& still, const cv::Mat& matte) {
  cv::Mat weight, mass;
  matte.convertTo(weight, CV_32F, 1.0 / 255);
  const int longer = std::max(still.cols, still.rows);
  const cv::Size cells(std::max(1, kColourCells * still.cols / longer),
                       std::max(1, kColourCells * still.rows / longer));
  const cv::Mat own = cell_means(still, weight, cells, mass);
  const double all = std::max(cv::sum(mass)[0], 1e-6);
  std::vector<double> drift(frames.size());
  oneapi::tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t i) {
    cv::Mat same, away = cell_means(frames[i], weight, cells, same) - own;
    std::vector<cv::Mat> channels;
    cv::split(away.mul(away), channels);
    for (const cv::Mat& squares : channels) drift[i] = std::max(drift[i], std::sqrt(squares.dot(mass) / all));
  });
  return drift.empty() ? 0 : *std::max_element(drift.begin(), drift.end());
}

}  // namespace freshet::bench
