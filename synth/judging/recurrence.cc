#include "synth/judging/recurrence.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "vision/dot.h"

namespace freshet::synth::judging {
namespace {

constexpr double kFinest = 1, kCoarsest = 10;  // sigmas of the band-pass, px

/// Two frames' forms, cell by cell: their correlation there.
cv::Mat correlation_by_cell(const cv::Mat& a, const cv::Mat& b, const cv::Mat& inside) {
  const cv::Mat ab = cell_means(a.mul(b), inside), aa = cell_means(a.mul(a), inside),
                bb = cell_means(b.mul(b), inside);
  cv::Mat scale;
  cv::sqrt(aa.mul(bb), scale);
  return ab / (scale + 1e-6);
}

}  // namespace

Reading recurrence(std::span<const cv::Mat> luma, const cv::Mat& matte) {
  const int frames = static_cast<int>(luma.size());
  if (frames <= kRecurrenceGap) return {};
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
  inside = inside > 127;
  const int counted = cv::countNonZero(inside);
  if (counted == 0) return {};
  std::vector<cv::Mat> bands(luma.size());
  cv::Mat forms(frames, counted, CV_32F);
  oneapi::tbb::parallel_for(0, frames, [&](int i) {
    const cv::Mat changed = reduced[static_cast<std::size_t>(i)] - mean;
    cv::Mat fine, coarse;
    cv::GaussianBlur(changed, fine, {}, kFinest);
    cv::GaussianBlur(changed, coarse, {}, kCoarsest);
    const cv::Mat band = fine - coarse;
    bands[static_cast<std::size_t>(i)] = band;
    auto* to = forms.ptr<float>(i);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        if (inside.at<std::uint8_t>(y, x) != 0) *to++ = band.at<float>(y, x);
    cv::Mat row = forms.row(i);
    row -= cv::mean(row)[0];
    row /= cv::norm(row) + 1e-6;
  });
  std::vector<double> most(luma.size());
  std::vector<cv::Mat> cells(luma.size());
  oneapi::tbb::parallel_for(0, frames, [&](int i) {
    double best = -1;
    int like = 0;
    for (int j = 0; j < frames; ++j)
      if (std::abs(i - j) >= kRecurrenceGap)
        if (const double alike = vision::dot(forms.row(i), forms.row(j)); alike > best) {
          best = alike;
          like = j;
        }
    most[static_cast<std::size_t>(i)] = best;
    cells[static_cast<std::size_t>(i)] = correlation_by_cell(bands[static_cast<std::size_t>(i)],
                                                             bands[static_cast<std::size_t>(like)], inside);
  });
  Reading reading{.value = 0, .map = {}};
  for (double best : most) reading.value += best / frames;
  std::vector<std::vector<cv::Mat>> spans(kSpans);
  for (int i = 0; i < frames; ++i)
    spans[static_cast<std::size_t>(span_of(i, frames))].push_back(cells[static_cast<std::size_t>(i)]);
  for (const auto& span : spans) reading.map.push_back(mean_of(span));
  return reading;
}

Reading recurrence(const Evidence& film) { return recurrence(film.luma(), film.matte()); }

}  // namespace freshet::synth::judging
