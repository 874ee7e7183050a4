// tests/synth/simulate/sample_hash.h — a number that tells whether two frames are the same to the bit.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "platform/random.h"

namespace freshet::synth::simulate {

/// Of all bytes of `mat`, in order, and of what was hashed before.
inline std::uint64_t hash_of_samples(const cv::Mat& mat, std::uint64_t hash) {
  for (int y = 0; y < mat.rows; ++y) {
    const std::uint8_t* p = mat.ptr<std::uint8_t>(y);
    for (std::size_t i = 0; i < static_cast<std::size_t>(mat.cols) * mat.elemSize(); ++i)
      hash = scramble(hash ^ p[i]);
  }
  return hash;
}

}  // namespace freshet::synth::simulate
