// synth/sampling/remapped.h — a plane read between its samples.
#pragma once

#include <cmath>

#include <opencv2/core.hpp>

namespace freshet::synth::sampling {

/// Where any place is found in a plane of `size` samples that goes on mirrored beyond its sides, up to 14 sizes away:
/// -0.5 .. size - 0.5.
[[gnu::always_inline]] inline float mirrored(float at, float size) {
  constexpr float kTurns = 8;  // so that what is cut off is positive
  const float farthest = 14 * size, low = at > -farthest ? at : -farthest;
  const float from = (low < farthest ? low : farthest) + 0.5f;
  const float turns = static_cast<float>(static_cast<int>(from / (2 * size) + kTurns)) - kTurns;
  return size - std::abs(size - (from - 2 * size * turns)) - 0.5f;
}

/// Where what is carried from `at` to `own` is found in a plane of `size` samples that goes on mirrored beyond its
/// sides, without the outermost hundredth: a picture's rim is often of its frame, and would be seen twice where the
/// fluid comes in.
[[gnu::always_inline]] inline float carried_from(float at, float own, float size) {
  const float away = std::abs(at - own), rim = away < size / 100 ? away : size / 100;
  return mirrored(at - rim, size - 2 * rim) + rim;
}

/// What cv::remap (INTER_LINEAR, BORDER_REPLICATE) reads of a plane, to the bit: places are rounded to 1/32 sample.
/// plane    CV_32F of 1, 2 or 4 channels, less than 32768 samples wide and high.
/// places   CV_32FC2, of x and y. out: as large, of the plane's type; may be none of the others. Safe from many
///          threads.
void read_remapped(const cv::Mat& plane, const cv::Mat& places, cv::Mat& out);

}  // namespace freshet::synth::sampling
