#include "ingest/frame_timing.h"

#include <algorithm>
#include <cmath>

namespace freshet::ingest {
namespace {

constexpr double kRounding = 0.1, kRounding_s = 0.002;

}  // namespace

double pair_rate(double interval_s, double clip_fps) {
  const double expected_s = 1 / clip_fps;
  if (interval_s <= 0 || std::abs(interval_s - expected_s) <= std::max(kRounding * expected_s, kRounding_s))
    return clip_fps;
  return 1 / interval_s;
}

FrameTiming timing_of(std::span<const double> times_s) {
  FrameTiming timing;
  if (times_s.size() < 2 || times_s.back() <= times_s.front()) return timing;
  timing.fps = static_cast<double>(times_s.size() - 1) / (times_s.back() - times_s.front());
  double shortest_s = times_s.back() - times_s.front();
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    const double interval_s = times_s[i] - times_s[i - 1];
    timing.steady = timing.steady && pair_rate(interval_s, timing.fps) == timing.fps;
    if (interval_s > 0) shortest_s = std::min(shortest_s, interval_s);
    if (interval_s <= timing.longest_gap_s) continue;
    timing.longest_gap_s = interval_s;
    timing.gap_after_s = times_s[i - 1] - times_s.front();
  }
  timing.slowest_fps = 1 / timing.longest_gap_s;
  timing.fastest_fps = 1 / shortest_s;
  return timing;
}

}  // namespace freshet::ingest
