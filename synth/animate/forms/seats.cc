#include "synth/animate/forms/seats.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {
namespace {

constexpr double kOutside = 0.025;      // of a seat's light, beyond each side of its box
constexpr double kMinShare = 1.0 / 30;  // of all light
constexpr double kFaint = 0.15;         // of the brightest column: what separates two fires is darker
constexpr double kMinGap = 0.02;        // of the frame's width

/// Where a running sum passes a fraction of the whole.
double quantile(const std::vector<double>& sums, double fraction) {
  const double total = std::accumulate(sums.begin(), sums.end(), 0.0);
  double run = 0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (run + sums[i] >= fraction * total && sums[i] > 0)
      return static_cast<double>(i) + (fraction * total - run) / sums[i];
    run += sums[i];
  }
  return static_cast<double>(sums.size());
}

Seat seat_within(const cv::Mat& level, int begin, int end) {
  std::vector<double> across(end - begin, 0.0), down(level.rows, 0.0);
  for (int y = 0; y < level.rows; ++y)
    for (int x = begin; x < end; ++x) {
      const double light = level.at<float>(y, x);
      across[x - begin] += light;
      down[y] += light;
    }
  return {.left = begin + quantile(across, kOutside),
          .top = quantile(down, kOutside),
          .right = begin + quantile(across, 1 - kOutside),
          .bed = quantile(down, 1 - kOutside),
          .first = static_cast<double>(begin),
          .last = static_cast<double>(end),
          .share = std::accumulate(across.begin(), across.end(), 0.0)};
}

}  // namespace

std::vector<Seat> seats_of(const cv::Mat& level) {
  cv::Mat sums;
  cv::reduce(level, sums, 0, cv::REDUCE_SUM, CV_32F);
  const double total = cv::sum(sums)[0];
  if (total <= 0) return {};
  const double sigma = std::max(0.6, 0.5 * kMinGap * level.cols);
  cv::GaussianBlur(sums, sums, {0, 1}, sigma, 0, cv::BORDER_CONSTANT);
  double brightest = 0;
  cv::minMaxLoc(sums, nullptr, &brightest);
  // Runs of lit columns; they meet in the middle of the dark between them.
  std::vector<std::pair<int, int>> runs;
  for (int x = 0; x < level.cols; ++x) {
    if (sums.at<float>(x) < kFaint * brightest) continue;
    if (!runs.empty() && x - runs.back().second <= std::max(1.0, kMinGap * level.cols))
      runs.back().second = x + 1;
    else
      runs.emplace_back(x, x + 1);
  }
  std::vector<Seat> seats;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const int begin = i == 0 ? 0 : (runs[i - 1].second + runs[i].first) / 2;
    const int end = i + 1 == runs.size() ? level.cols : (runs[i].second + runs[i + 1].first) / 2;
    Seat seat = seat_within(level, begin, end);
    seat.share /= total;
    if (seat.share >= kMinShare) seats.push_back(seat);
  }
  while (seats.size() > kMaxSeats)
    seats.erase(std::min_element(seats.begin(), seats.end(),
                                 [](const Seat& a, const Seat& b) { return a.share < b.share; }));
  return seats;
}

std::vector<Seat> seats_reduced(const cv::Mat& level, int samples) {
  const double by = std::max(1.0, std::max(level.cols, level.rows) / static_cast<double>(samples));
  cv::Mat reduced;
  cv::resize(level, reduced, {std::max(1, cvRound(level.cols / by)), std::max(1, cvRound(level.rows / by))},
             0, 0, cv::INTER_AREA);
  std::vector<Seat> seats = seats_of(reduced);
  for (Seat& seat : seats) {
    for (double* x : {&seat.left, &seat.right, &seat.first, &seat.last})
      *x *= level.cols / static_cast<double>(reduced.cols);
    for (double* y : {&seat.top, &seat.bed}) *y *= level.rows / static_cast<double>(reduced.rows);
  }
  return seats;
}

Seat together(const std::vector<Seat>& seats, int columns) {
  Seat all = seats.front();
  for (const Seat& seat : seats) {
    all.left = std::min(all.left, seat.left);
    all.right = std::max(all.right, seat.right);
    all.top = std::min(all.top, seat.top);
    all.bed = std::max(all.bed, seat.bed);
  }
  all.first = 0;
  all.last = columns;
  all.share = 0;
  for (const Seat& seat : seats) all.share += seat.share;
  return all;
}

}  // namespace freshet::synth::animate
