// bench/harness/seeded_random.h — random numbers that are the same on every machine.
#pragma once

#include <cstdint>

namespace freshet::bench {

/// splitmix64: every seed is a good one. The standard's distributions differ between libraries.
class SeededRandom {
 public:
  explicit SeededRandom(std::uint64_t seed, std::uint64_t number = 0) : state_(seed) {
    state_ = next() + number * 0xbf58476d1ce4e5b9ull;
    next();
  }
  std::uint64_t next() {
    std::uint64_t value = state_ += 0x9e3779b97f4a7c15ull;
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ull;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebull;
    return value ^ (value >> 31);
  }
  /// In [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double uniform(double minimum, double maximum) { return minimum + (maximum - minimum) * uniform(); }
  /// Mean 0, deviation 1: the sum of twelve uniform ones, which needs no logarithm.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }
  /// In [0, count).
  std::uint64_t below(std::uint64_t count) { return next() % count; }

 private:
  std::uint64_t state_;
};

}  // namespace freshet::bench
