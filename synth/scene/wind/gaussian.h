// synth/scene/wind/gaussian.h — normally distributed noise of the frequency domain.
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>

#include "platform/random.h"

namespace freshet::synth::scene {

/// Complex, with mean 0 and E|z|^2 = 1; the same for one random stream and index, whatever was asked before.
inline std::complex<double> complex_gaussian(const Random& random, std::uint64_t index) {
  // 1 - u lies above 0: its logarithm is finite.
  const double u = 1.0 - static_cast<double>(random.at(2 * index)), turns = random.at(2 * index + 1);
  return std::polar(std::sqrt(-std::log(u)), 2 * std::numbers::pi * turns);
}

}  // namespace freshet::synth::scene
