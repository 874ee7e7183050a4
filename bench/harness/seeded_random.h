// bench/harness/seeded_random.h — a stream of draws of several distributions.
#pragma once

#include <cstdint>

#include "platform/random.h"

namespace freshet::bench {

/// The distributions are written out: the standard's differ between libraries.
class SeededRandom {
 public:
  explicit SeededRandom(std::uint64_t seed, std::uint64_t number = 0) : draws_(seed) {
    draws_ = SplitMix64(next() + number * 0xbf58476d1ce4e5b9ull);
    next();
  }
  std::uint64_t next() { return draws_.next(); }
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
  SplitMix64 draws_;
};

}  // namespace freshet::bench
