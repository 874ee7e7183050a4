#include "synth/flowlines/ladder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"

namespace freshet::synth::flowlines {
namespace {

constexpr int kReduced = 4;
constexpr int kTaps = 2;  // sheared frames to either side that a comparison looks at
constexpr std::array<double, 2 * kTaps + 1> kBinomial{1.0 / 16, 4.0 / 16, 6.0 / 16, 4.0 / 16, 1.0 / 16};
constexpr std::array<double, 5> kShares{1, 0.85, 0.7, 0.5, 0.35};  // of the way, that are tried
constexpr int kTrial = 400;                                        // frames of an order that is tried

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
cv::Mat sheared(const std::vector<cv::Mat>& frames, const Places& places, float share, int entry) {
  cv::Mat row(1, static_cast<int>(places.at.size()), CV_8UC3);
  const int last = static_cast<int>(frames.size()) - 1;
  for (int i = 0; i < row.cols; ++i) {
    const int frame =
        std::clamp(entry + cvRound(share * places.arrival[static_cast<std::size_t>(i)]), 0, last);
    row.at<cv::Vec3b>(i) =
        frames[static_cast<std::size_t>(frame)].at<cv::Vec3b>(places.at[static_cast<std::size_t>(i)]);
  }
  return row;
}

/// cost(a, b) for entries of the plan, 1 for what unrelated ones differ by.
cv::Mat jump_costs(const std::vector<cv::Mat>& frames, const Places& places, float share, int first,
                   int entries) {
  const int rows = entries + 1 + 2 * kTaps;
  std::vector<cv::Mat> shown(static_cast<std::size_t>(rows));
  cv::Mat plain(rows, rows, CV_64F, cv::Scalar(0));
  tbb::parallel_for(0, rows, [&](int i) {
    shown[static_cast<std::size_t>(i)] = sheared(frames, places, share, first - kTaps + i);
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

/// Cost by frame of the order that would be made.
double tried(const cv::Mat& cost, const RepeatOptions& options) {
  Repeats repeats(cost, options);
  double sum = 0;
  std::int64_t end = 0;
  while (end < kTrial) {
    end = repeats.next().end();
    sum += repeats.jump();
  }
  return sum / static_cast<double>(end);
}

}  // namespace

Ladder plan_ladder(const std::vector<cv::Mat>& frames, const Stream& stream, const cv::Mat& where,
                   const std::string& name, const LadderOptions& options, const Job& job) {
  const int count = static_cast<int>(frames.size());
  const int room = count - 2 * options.margin;  // for entries and the way together
  const int fewest = options.entries > 0 ? options.entries : std::min(options.min_entries, room / 2);
  if (room < 8 || (options.entries == 0 && fewest < 4))
    throw Error(
        ErrorKind::kInput, name, fmt::format("it has {} frames, too few to repeat any", count),
        fmt::format("Give a clip of {} frames or more, two seconds are good", 2 * options.margin + 24));
  if (options.entries > room - 1)
    throw Error(ErrorKind::kUsage, fmt::format("--entries {}", options.entries),
                fmt::format("of the clip's {} frames at most {} can be repeated", count, room - 1),
                "Ask for fewer, or give a longer clip");
  const cv::Size reduced(std::max(1, frames.front().cols / kReduced),
                         std::max(1, frames.front().rows / kReduced));
  std::vector<cv::Mat> small(frames.size());
  tbb::parallel_for(std::size_t{0}, frames.size(),
                    [&](std::size_t i) { cv::resize(frames[i], small[i], reduced, 0, 0, cv::INTER_AREA); });
  const Places places = places_of(stream, where, reduced);
  std::optional<Ladder> best;
  double least = 0;
  for (const double share : kShares) {
    if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "repeats", "stopped");
    // The front gets as far as the clip's frames leave room for beside the entries.
    const double longest = room - fewest;
    const double by = std::min(share, longest / static_cast<double>(stream.duration));
    const int way = static_cast<int>(std::ceil(by * static_cast<double>(stream.duration)));
    const int entries = options.entries > 0 ? options.entries : room - way;
    if (entries < 4) continue;
    Ladder ladder{.first = options.margin, .cost = {}, .hastened = by, .per_frame = 0, .min_run = 6};
    ladder.cost = places.at.empty()
                      ? cv::Mat(entries + 1, entries, CV_32F, cv::Scalar(0))
                      : jump_costs(small, places, static_cast<float>(by), ladder.first, entries);
    // Two rungs stay further apart than feathering is wide, as far as there is room.
    ladder.min_run = std::clamp(entries / 3, 2, 2 * options.margin + 2);
    RepeatOptions repeats = options.repeats;
    repeats.min_run = ladder.min_run;
    ladder.per_frame = tried(ladder.cost, repeats);
    // A front that outruns the fluid passes over each particle that it cuts: as much as a rung along the whole way.
    const double price = ladder.per_frame * (1 + (1 - by));
    if (!best || price < least) {
      least = price;
      best = std::move(ladder);
    }
    if (options.entries > 0) break;
  }
  return *best;
}

}  // namespace freshet::synth::flowlines
