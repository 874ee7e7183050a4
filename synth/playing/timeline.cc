#include "synth/playing/timeline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::synth::playing {
namespace {

/// The position, in frames, of a time; beyond the ends the end frames.
double position_of(std::span<const double> times, double t, bool whole) {
  if (times.size() == 1 || t <= times.front()) return 0;
  const auto next = std::upper_bound(times.begin(), times.end(), t);
  if (next == times.end()) return static_cast<double>(times.size() - 1);
  const auto before = static_cast<double>(next - times.begin() - 1);
  const double fraction = (t - next[-1]) / (next[0] - next[-1]);
  if (whole) return before + (fraction >= 0.5 ? 1 : 0);
  // A frame missed by an error of rounding is that frame: between frames all is computed.
  constexpr double kRounding = 1e-6;
  return fraction < kRounding ? before : fraction > 1 - kRounding ? before + 1 : before + fraction;
}

/// A clip as a loop: begin .. end in its own time, s, and half the fade.
struct Circle {
  double begin = 0, end = 0, half = 0, correlation = 0;
  double length() const { return end - begin; }
};

class Player {
 public:
  Player(std::span<const double> times, const Circle& circle, bool whole)
      : times_(times), circle_(circle), whole_(whole) {}

  /// One moment `elapsed` seconds after a boundary at which the old stretch ends and the new one begins, or
  /// before it, where elapsed < 0.
  Moment near_boundary(double elapsed) const {
    const double turn = (elapsed + circle_.half) / (2 * circle_.half) * std::numbers::pi / 2;
    const double old_weight = std::cos(turn), new_weight = std::sin(turn);
    const double norm = std::sqrt(1 + 2 * old_weight * new_weight * circle_.correlation);
    Moment moment{.at = {position_of(times_, circle_.end + elapsed, whole_),
                         position_of(times_, circle_.begin + elapsed, whole_)},
                  .weight = {static_cast<float>(old_weight / norm), static_cast<float>(new_weight / norm)}};
    if (moment.at[0] == moment.at[1]) moment = {.at = {moment.at[0], 0}, .weight = {1, 0}};
    return moment;
  }
  Moment at(double t) const { return {.at = {position_of(times_, t, whole_), 0}, .weight = {1, 0}}; }

 private:
  std::span<const double> times_;
  Circle circle_;
  bool whole_;
};

}  // namespace

std::vector<Moment> timeline(std::span<const double> times, double interval,
                             const std::optional<vision::LoopRule>& rule, const std::string& where,
                             const TimelineOptions& options) {
  std::vector<Moment> moments(options.frames);
  const double step = options.speed / options.fps, lasts = times.back() - times.front();
  if (!options.loop && (options.frames - 1) * step <= lasts + interval) {
    // Half a frame of either side is as near as a nearest frame can be.
    const Player player(times, {}, options.whole);
    for (int i = 0; i < options.frames; ++i) moments[i] = player.at(times.front() + i * step);
    return moments;
  }
  if (!rule) {
    const std::string length =
        fmt::format("the clip has {} frames in {:.2f} s", times.size(), lasts + interval);
    if (options.loop)
      throw Error(ErrorKind::kInput, where,
                  fmt::format("{}, too short to make a loop of: {} frames are needed", length,
                              vision::kMinLoopFrames),
                  "Leave it out with --exclude, or animate without --loop");
    throw Error(
        ErrorKind::kInput, where,
        fmt::format("{}, too short for an animation of {:.2f} s and to make a loop of: {} frames are needed",
                    length, options.frames / options.fps, vision::kMinLoopFrames),
        "Ask for fewer frames, or leave it out with --exclude");
  }

  Circle circle{.begin = times[rule->to],
                .end = times[rule->from],
                .half = (times[rule->from + rule->fade / 2] - times[rule->from]),
                .correlation = std::clamp(1 - rule->distance, 0.0, 1.0)};
  circle.half = std::max(circle.half, interval);
  if (!options.loop) {
    const Player player(times, circle, options.whole);
    for (int i = 0; i < options.frames; ++i) {
      const double elapsed = i * step, first = circle.end - times.front();
      // The nearest boundary, and the time since it.
      const double loops = std::max(0.0, std::round((elapsed - first) / circle.length()));
      const double since = elapsed - (first + loops * circle.length());
      if (std::abs(since) < circle.half)
        moments[i] = player.near_boundary(since);
      else
        moments[i] = player.at(since < 0 ? circle.end + since : circle.begin + since);
    }
    return moments;
  }

  // A whole number of loops in the period: as many as bring their length near the rule's, and no fewer than
  // the clip is long enough for.
  const double period = options.frames * step;
  circle.half = std::min(circle.half, period / 4);
  const double longest = lasts - 2 * circle.half;
  const double loops =
      std::max({1.0, std::round(period / circle.length()), std::ceil(period / longest - 1e-9)});
  const double length = period / loops;
  circle.half = std::min(circle.half, length / 4);
  // Of another length than its own the rule's likeness says nothing.
  if (std::abs(length - circle.length()) > interval / 2) circle.correlation = 0;
  const double first = times.front() + circle.half, last = times.back() - circle.half - length;
  circle.begin = std::clamp(circle.begin, first, std::max(first, last));
  circle.end = circle.begin + length;
  const Player player(times, circle, options.whole);
  // From the last frame to the first only half a step of time goes by, made good in the steps after it: every
  // step changes the picture by another amount, and this one is not to stand out.
  constexpr double kSeam = 0.5;
  const int later = std::min(16, options.frames - 1);
  const auto passed = [&](int i) {
    return options.whole || later < 1 ? i : i + (1 - kSeam) * std::min(i, later) / later;
  };
  for (int i = 0; i < options.frames; ++i) {
    const double elapsed = std::fmod(passed(i) * step + options.phase * period, length);
    if (elapsed < circle.half)
      moments[i] = player.near_boundary(elapsed);
    else if (elapsed > length - circle.half)
      moments[i] = player.near_boundary(elapsed - length);
    else
      moments[i] = player.at(circle.begin + elapsed);
  }
  return moments;
}

FrameWeights frame_weights(std::span<const Moment> moments) {
  FrameWeights weights;
  double total = 0;
  for (const Moment& moment : moments)
    each_frame(moment, [&](std::uint32_t frame, double weight) {
      weights[frame] += weight;
      total += weight;
    });
  for (auto& [frame, weight] : weights) weight /= total;
  return weights;
}

}  // namespace freshet::synth::playing
