// synth/judging/reading.h — what a measure says of a film: one figure, and where in picture and time it comes from.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::judging {

inline constexpr int kCells = 16;  // of a map, along the picture's longer side
inline constexpr int kSpans = 4;   // of time, equally long
inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

struct Reading {
  double value = kNotMeasured;  // in the measure's unit; NaN: this film does not tell
  /// One map a span of time: CV_32F, cells_of() cells, in the same unit; NaN where hardly anything is fluid. Empty: the
  /// measure has no place.
  std::vector<cv::Mat> map{};
};

/// Where and when a map is greatest.
struct Worst {
  bool found = false;  // false: the map is empty
  cv::Point cell;
  int span = 0;
  double value = 0;
};
Worst worst_of(const Reading& reading);

cv::Size cells_of(cv::Size picture);
/// Weighted means over cells.
/// values   CV_32F. weight   CV_8U of the same size: the matte.
/// Returns  CV_32F, NaN in cells of which less than a quarter is fluid.
cv::Mat cell_means(const cv::Mat& values, const cv::Mat& weight);
/// Mean of the values that are there; NaN without any.
double mean_of(const cv::Mat& cells);
/// Cell by cell, the mean of those maps that have a value there.
cv::Mat mean_of(std::span<const cv::Mat> maps);
/// The span that frame `frame` of `frames` lies in.
int span_of(int frame, int frames);

}  // namespace freshet::synth::judging
