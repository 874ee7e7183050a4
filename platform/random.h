// platform/random.h — random numbers that are the same on every machine and for any number of threads.
#pragma once

#include <cstdint>

namespace freshet {

constexpr std::uint64_t kSplitMixStep = 0x9e3779b97f4a7c15ULL;

/// One draw of SplitMix64 (Steele, Lea, Flood 2014), which is also a hash of 64 bits: every input bit reaches every
/// output bit.
inline std::uint64_t scramble(std::uint64_t x) {
  x += kSplitMixStep;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// SplitMix64: one draw after the other. Every seed is a good one.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    const std::uint64_t drawn = scramble(state_);
    state_ += kSplitMixStep;
    return drawn;
  }

 private:
  std::uint64_t state_;
};

/// One stream of draws, where a value is a function of (seed, stream, index) alone. at(i) may be asked in any order
/// from any thread; next draws walk i upwards.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream) : key_(scramble(scramble(seed) + stream)) {}

  std::uint64_t bits(std::uint64_t index) const { return scramble(key_ + index); }
  float at(std::uint64_t index) const { return static_cast<float>(bits(index) >> 40) * 0x1p-24f; }  // [0, 1)

  float next() { return at(counter_++); }
  float between(float low, float high) { return low + (high - low) * next(); }
  int below(int n) { return static_cast<int>(next() * static_cast<float>(n)); }  // 0 .. n - 1
  float sign() { return next() < 0.5f ? -1.0f : 1.0f; }

 private:
  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

/// Cheap 32-bit hash for dither, where three multiplies per pixel would show in the profile.
inline std::uint32_t scramble32(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

}  // namespace freshet
