// synth/field/portable_math.h — the few transcendental functions that the scenes need, same bits everywhere.
//
// The C library picks its exp, pow and sin by CPU (with or without fused multiply-add), so
// the last bit differs between machines; these use only + - * / and are built without
// contraction. Relative error below 1e-5.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "platform/smoothstep.h"

namespace freshet::synth {

inline constexpr float kPi = 3.14159265f;

/// Largest integer not above x, for |x| < 2^30; std::floor is a library call on baseline x86-64.
inline int floor_int(float x) {
  const int truncated = static_cast<int>(x);
  return truncated - static_cast<int>(x < static_cast<float>(truncated));
}

/// 2^x; x is clamped to -126..126.
inline float exp2_portable(float x) {
  x = x > -126.0f ? (x < 126.0f ? x : 126.0f) : -126.0f;
  const int whole = floor_int(x);
  const float f = x - static_cast<float>(whole);
  const float mantissa =
      1.0f +
      f * (0.69314718f +
           f * (0.24022651f + f * (0.05550411f + f * (0.00961813f + f * 0.00133336f + f * f * 0.00015469f))));
  return mantissa * std::bit_cast<float>(static_cast<std::uint32_t>(whole + 127) << 23);
}

inline float exp_portable(float x) { return exp2_portable(x * 1.44269504f); }

/// x > 0.
inline float log2_portable(float x) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
  int exponent = static_cast<int>(bits >> 23) - 127;
  float m = std::bit_cast<float>((bits & 0x007fffffu) | 0x3f800000u);
  if (m > 1.41421356f) m *= 0.5f, ++exponent;
  const float s = (m - 1.0f) / (m + 1.0f), s2 = s * s;
  const float ln =
      2.0f * s * (1.0f + s2 * (0.33333333f + s2 * (0.2f + s2 * (0.14285714f + s2 * 0.11111111f))));
  return static_cast<float>(exponent) + ln * 1.44269504f;
}

/// x >= 0.
inline float pow_portable(float x, float y) { return x > 0.0f ? exp2_portable(y * log2_portable(x)) : 0.0f; }

/// sin(2 pi turns), |turns| < 2^20. Quarter-wave symmetry, then the Taylor series to x^9.
inline float sin_turns(float turns) {
  float t = turns - static_cast<float>(floor_int(turns + 0.5f));  // -0.5 .. 0.5
  if (t > 0.25f) t = 0.5f - t;
  if (t < -0.25f) t = -0.5f - t;
  const float x = t * 6.28318531f, x2 = x * x;
  return x * (1.0f + x2 * (-0.16666667f + x2 * (0.00833333f + x2 * (-0.00019841f + x2 * 0.0000027557f))));
}
inline float cos_turns(float turns) { return sin_turns(turns + 0.25f); }

inline float lerp(float a, float b, float t) { return a + (b - a) * t; }

}  // namespace freshet::synth
