#include "synth/flowlines/jumps/repeats.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace freshet::synth::flowlines {
namespace {

/// 0..1 from numbers: splitmix64.
double drawn(std::uint64_t value) {
  value += 0x9e3779b97f4a7c15u;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((value ^ (value >> 31)) >> 11) * 0x1p-53;
}

/// Mean cost of jumps that are jumps: the unit of freshness and chance.
double unit_of(const cv::Mat& cost) {
  double sum = 0;
  int count = 0;
  for (int a = 0; a < cost.rows; ++a)
    for (int b = 0; b < cost.cols; ++b)
      if (std::abs(a - b) > 2) {
        sum += static_cast<double>(cost.at<float>(a, b));
        ++count;
      }
  return count > 0 && sum > 0 ? sum / count : 1;
}

/// How many times as much a jump shows for the frames that it lacks to go over in.
double hurried(double room, const RepeatOptions& options) {
  return std::max(1.0, options.fade / std::max(1.0, room));
}

constexpr double kForgotten = 0.75;  // a jump's use, by each jump after it
constexpr int kLike = 2;             // frames between jumps that look the same

}  // namespace

Repeats::Repeats(const cv::Mat& cost, const RepeatOptions& options)
    : cost_(cost),
      options_(options),
      unit_(unit_of(cost)),
      used_(cost.size(), CV_32F, cv::Scalar(0)),
      random_(options.seed * 0x100000001b3u) {}

double Repeats::chance() { return drawn(random_++); }

Run Repeats::next() {
  const int entries = cost_.cols;
  if (options_.in_turn) {
    const Run whole{.start = start_, .first = 0, .length = entries};
    jump_ = jump_to_come_;
    jump_to_come_ = static_cast<double>(cost_.at<float>(entries, 0));
    start_ += entries;
    return whole;
  }
  Run run{.start = start_, .first = first_, .length = 0};
  double least = std::numeric_limits<double>::max();
  int next = 0;
  double jump = 0;
  // Runs that begin all but together are the same to the eye.
  const int apart = std::max(1, std::min(entries / 8, entries - 2 * options_.min_run));
  for (int end = first_ + options_.min_run; end <= entries; ++end)
    for (int b = 0; b + options_.min_run <= entries; ++b) {
      if (std::abs(b - first_) < apart || std::abs(b - end) < 2) continue;
      // A longer run puts the jump off, and has its cost for more frames; but the longest one again and again is a
      // loop: a small power.
      const auto cost = static_cast<double>(cost_.at<float>(end, b));
      const double price =
          (cost + unit_ * (options_.freshness * static_cast<double>(used_.at<float>(end, b)) +
                           options_.chance * chance())) *
          std::pow(entries / static_cast<double>(end - first_), 0.3) *
          hurried(0.5 * (end - first_), options_);
      if (price >= least) continue;
      least = price;
      run.length = end - first_;
      next = b;
      jump = cost;
    }
  used_ *= kForgotten;
  for (int a = std::max(0, first_ + run.length - kLike); a <= std::min(entries, first_ + run.length + kLike);
       ++a)
    for (int b = std::max(0, next - kLike); b <= std::min(entries - 1, next + kLike); ++b)
      used_.at<float>(a, b) += 1;
  start_ += run.length;
  first_ = next;
  jump_ = jump_to_come_;
  jump_to_come_ = jump;
  return run;
}

std::vector<Run> cyclic(const cv::Mat& cost, int frames, const RepeatOptions& options) {
  const int entries = cost.cols, least = options.min_run;
  if (options.in_turn) {
    std::vector<Run> runs;
    for (int start = 0; frames % entries == 0 && start < frames; start += entries)
      runs.push_back({.start = start, .first = 0, .length = entries});
    return runs;
  }
  constexpr float kNever = std::numeric_limits<float>::max();
  const auto unit = static_cast<float>(unit_of(cost));
  const int firsts = entries - least + 1;  // entries at which a run can begin
  if (firsts < 2 || frames < 2 * least) return {};
  // best(t, b): the least cost of runs that fill frames [0, t) and go on with entry b, when they began with entry
  // `origin`; which run came before. The origin is where jumps back are cheapest.
  int origin = 0;
  float cheapest = kNever;
  for (int b = 0; b < firsts; ++b)
    for (int a = b + least; a <= entries; ++a)
      if (cost.at<float>(a, b) < cheapest && std::abs(a - b) >= 2) {
        cheapest = cost.at<float>(a, b);
        origin = b;
      }
  cv::Mat best(frames + 1, firsts, CV_32F, cv::Scalar(kNever));
  cv::Mat before(frames + 1, firsts, CV_32SC2,
                 cv::Scalar::all(-1));  // first entry and length of the run before
  best.at<float>(0, origin) = 0;
  for (int t = 0; t < frames; ++t)
    for (int first = 0; first < firsts; ++first) {
      const float until = best.at<float>(t, first);
      if (until == kNever) continue;
      for (int length = least; first + length <= entries && t + length <= frames; ++length) {
        const auto hurry = static_cast<float>(hurried(0.5 * length, options));
        for (int b = 0; b < firsts; ++b) {
          if (b == first || std::abs(b - first - length) < 2) continue;
          if (t + length == frames && b != origin) continue;
          const auto by_chance = static_cast<float>(
              options.chance *
              drawn(options.seed * 1000003u + static_cast<std::uint64_t>(t + length) * 4099u +
                    static_cast<std::uint64_t>(first + length) * 64u * 61u + static_cast<std::uint64_t>(b)));
          const float price = until + (cost.at<float>(first + length, b) + unit * by_chance) * hurry;
          if (price >= best.at<float>(t + length, b)) continue;
          best.at<float>(t + length, b) = price;
          before.at<cv::Vec2i>(t + length, b) = cv::Vec2i(first, length);
        }
      }
    }
  if (best.at<float>(frames, origin) == kNever) return {};
  std::vector<Run> runs;
  for (int t = frames, b = origin; t > 0;) {
    const cv::Vec2i run = before.at<cv::Vec2i>(t, b);
    t -= run[1];
    b = run[0];
    runs.push_back({.start = t, .first = run[0], .length = run[1]});
  }
  std::reverse(runs.begin(), runs.end());
  return runs;
}

}  // namespace freshet::synth::flowlines
