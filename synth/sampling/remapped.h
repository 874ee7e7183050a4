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

/// Where a picture lies along a plane of `size` samples: [first, end).
struct Span {
  float first, end, size;
};
inline Span span_of(int first, int length, int size) {
  return {static_cast<float>(first), static_cast<float>(first + length), static_cast<float>(size)};
}

/// Of a length: a picture's rim, often of its frame, which would be seen twice where the fluid comes in.
inline constexpr int kRims = 50;

/// Of what is carried over a side of the picture, how much of its end is left out: its rim.
[[gnu::always_inline]] inline float rim_left_out(float at, float own, const Span& picture) {
  const float away = std::abs(at - own), most = (picture.end - picture.first) / kRims;
  return away < most ? away : most;
}

/// How far beyond the picture or within its rim what is carried from `at` to `own` lies: < 0 before it, > 0 after it.
[[gnu::always_inline]] inline float beyond(float at, float own, const Span& picture) {
  const float rim = rim_left_out(at, own, picture);
  const float before = at - (picture.first + rim - 0.5f), after = at - (picture.end - rim - 0.5f);
  return (before < 0 ? before : 0.0f) + (after > 0 ? after : 0.0f);
}

/// Where it is found in a plane in which the picture goes on beyond its sides, and which itself goes on mirrored. The
/// rim is left out once on either side of the border: to a plane that ends there it is mirrored.
[[gnu::always_inline]] inline float carried_from(float at, float own, const Span& picture) {
  const float over = beyond(at, own, picture), rim = 2 * rim_left_out(at, own, picture);
  return mirrored(at + (over < 0 ? -rim : over > 0 ? rim : 0.0f), picture.size);
}

/// What cv::remap (INTER_LINEAR, BORDER_REPLICATE) reads of a plane, to the bit: places are rounded to 1/32 sample.
/// plane    CV_32F of 1, 2 or 4 channels, less than 32768 samples wide and high.
/// places   CV_32FC2, of x and y. out: as large, of the plane's type; may be none of the others. Safe from many
///          threads.
void read_remapped(const cv::Mat& plane, const cv::Mat& places, cv::Mat& out);

}  // namespace freshet::synth::sampling
