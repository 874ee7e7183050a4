#include "synth/flowlines/ladder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::flowlines {
namespace {

constexpr int kReduced = 4;
constexpr int kTaps = 2;  // sheared frames to either side that a comparison looks at
constexpr std::array<double, 2 * kTaps + 1> kBinomial{1.0 / 16, 4.0 / 16, 6.0 / 16, 4.0 / 16, 1.0 / 16};
constexpr int kTrial = 400;  // frames of an order that is tried

/// The stream's places of reduced frames, with their arrivals.
struct Places {
  std::vector<int> at;  // index into a reduced frame
  std::vector<float> arrival;
};

Places places_of(const Stream& stream, const cv::Mat& where, cv::Size reduced) {
  cv::Mat inside, arrival;
  cv::resize(where, inside, reduced, 0, 0, cv::INTER_NEAREST);
  cv::resize(stream.arrival, arrival, reduced, 0, 0, cv::INTER_NEAREST);
  Places places;
  for (int y = 0; y < reduced.height; ++y)
    for (int x = 0; x < reduced.width; ++x)
      if (inside.at<std::uint8_t>(y, x) != 0) {
        places.at.push_back(y * reduced.width + x);
        places.arrival.push_back(arrival.at<float>(y, x));
      }
  return places;
}

/// Frame e of the sheared clip: a row of the stream's places.
cv::Mat sheared(const std::vector<cv::Mat>& frames, const Places& places, int entry) {
  cv::Mat row(1, static_cast<int>(places.at.size()), CV_8UC3);
  const int last = static_cast<int>(frames.size()) - 1;
  for (int i = 0; i < row.cols; ++i) {
    const int frame = std::clamp(entry + cvRound(places.arrival[static_cast<std::size_t>(i)]), 0, last);
    row.at<cv::Vec3b>(i) =
        frames[static_cast<std::size_t>(frame)].at<cv::Vec3b>(places.at[static_cast<std::size_t>(i)]);
  }
  return row;
}

/// cost(a, b) for entries of the plan, 1 for what unrelated ones differ by.
cv::Mat jump_costs(const std::vector<cv::Mat>& frames, const Places& places, int first, int entries) {
  const int rows = entries + 1 + 2 * kTaps;
  std::vector<cv::Mat> shown(static_cast<std::size_t>(rows));
  cv::Mat plain(rows, rows, CV_64F, cv::Scalar(0));
  tbb::parallel_for(0, rows, [&](int i) {
    shown[static_cast<std::size_t>(i)] = sheared(frames, places, first - kTaps + i);
  });
  tbb::parallel_for(0, rows, [&](int i) {
    for (int j = 0; j < i; ++j)
      plain.at<double>(i, j) = plain.at<double>(j, i) =
          cv::norm(shown[static_cast<std::size_t>(i)], shown[static_cast<std::size_t>(j)], cv::NORM_L2SQR);
  });
  cv::Mat cost(entries + 1, entries, CV_32F, cv::Scalar(0));
  double unrelated = 0;
  int pairs = 0;
  for (int a = 0; a <= entries; ++a)
    for (int b = 0; b < entries; ++b) {
      double sum = 0;
      for (int k = -kTaps; k <= kTaps; ++k)
        sum +=
            kBinomial[static_cast<std::size_t>(k + kTaps)] * plain.at<double>(a + kTaps + k, b + kTaps + k);
      cost.at<float>(a, b) = static_cast<float>(sum);
      if (std::abs(a - b) > entries / 3) {
        unrelated += sum;
        ++pairs;
      }
    }
  if (unrelated > 0) cost *= pairs / unrelated;
  return cost;
}

/// What an order as it would be made costs.
void try_out(Ladder& ladder, const RepeatOptions& options) {
  Repeats repeats(ladder.cost, options);
  double sum = 0;
  int jumps = 0;
  std::int64_t end = 0;
  for (; end < kTrial; ++jumps) {
    end = repeats.next().end();
    sum += repeats.jump();
  }
  ladder.per_frame = sum / static_cast<double>(end);
  ladder.jump = sum / jumps;
}

}  // namespace

Ladders::Ladders(const std::vector<cv::Mat>& frames) : small_(frames.size()) {
  const cv::Size reduced(std::max(1, frames.front().cols / kReduced),
                         std::max(1, frames.front().rows / kReduced));
  tbb::parallel_for(std::size_t{0}, frames.size(),
                    [&](std::size_t i) { cv::resize(frames[i], small_[i], reduced, 0, 0, cv::INTER_AREA); });
}

Ladder Ladders::of(const Stream& stream, const cv::Mat& where, int margin, int entries,
                   const RepeatOptions& options) const {
  const Places places = places_of(stream, where, small_.front().size());
  Ladder ladder{.first = margin, .cost = {}};
  ladder.cost = places.at.empty() ? cv::Mat(entries + 1, entries, CV_32F, cv::Scalar(0))
                                  : jump_costs(small_, places, margin, entries);
  // Two rungs stay further apart than feathering is wide, as far as there is room.
  ladder.min_run = std::clamp(entries / 3, 2, 2 * margin + 2);
  RepeatOptions repeats = options;
  repeats.min_run = ladder.min_run;
  try_out(ladder, repeats);
  return ladder;
}

}  // namespace freshet::synth::flowlines
