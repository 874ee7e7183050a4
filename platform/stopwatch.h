// platform/stopwatch.h — how long work took, on the wall's clock.
#pragma once

#include <chrono>

namespace freshet {

/// Runs from when it is made. Costs one reading of the steady clock, some 25 ns.
class Stopwatch {
 public:
  /// Seconds since it was made, or since the last lap().
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  /// The same, and starts again: laps leave no gap.
  double lap() {
    const Clock::time_point now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    start_ = now;
    return seconds;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// Adds the life of a scope to a number of seconds, also when the scope is left by an exception.
class TimedScope {
 public:
  explicit TimedScope(double& seconds) : seconds_(seconds) {}
  TimedScope(const TimedScope&) = delete;
  TimedScope& operator=(const TimedScope&) = delete;
  ~TimedScope() { seconds_ += watch_.seconds(); }

 private:
  double& seconds_;
  Stopwatch watch_;
};

}  // namespace freshet
