#include "query/costs/cell_log_features.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include "platform/vectors.h"
#include "vision/patch_features.h"

namespace freshet::query {
namespace {

constexpr float kFrameRate = 25;             // frames per second, of the paper's px per frame
constexpr float kSpeedFloor = 2.5f;          // px/s; slower motion is as good as none
constexpr float kPowerFloor = 1;             // (px/s)^2
constexpr float kTextureFloor = 1.0f / 512;  // half a grey level of 8 bits

// Natural logarithm of 1 + x, x >= 0, to 2e-7 of its size or of 1. The C library's takes other code, and
// gives other last bits, on machines with fused multiply-add; this one is the same everywhere, and is
// vectorised (log1p took two thirds of the time of all tables).
inline float log_1_plus(float x) {
  const float y = 1 + x;
  const auto bits = std::bit_cast<std::int32_t>(y);
  const std::int32_t exponent = (bits - std::bit_cast<std::int32_t>(0.70710678f)) >> 23;
  const float f = std::bit_cast<float>(bits - exponent * (1 << 23)) - 1;  // y = (1 + f) * 2^exponent
  const float s = f / (2 + f), s2 = s * s;  // log(1 + f) = 2 artanh(s), |s| <= 0.172
  const float series = 1 + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 * (1.0f / 9))));
  return 0.69314718f * static_cast<float>(exponent) + 2 * s * series;
}

inline float or_zero(float value) { return value > 0 ? value : 0; }

// The nearest level, of a value in either direction.
inline std::int16_t level_of(float value) {
  constexpr float kMax = kMaxLogStep;
  const float levels = value < -kMax ? -kMax : value > kMax ? kMax : value;
  return static_cast<std::int16_t>(static_cast<std::int32_t>(levels + (kMax + 0.5f)) - kMaxLogStep);
}

// out[i] = level of scale * log(1 + in[i] / floor), for each cell.
FRESHET_WIDE void log_levels(const float* in, std::size_t cells, std::size_t step, std::size_t channels,
                             float per_floor, float scale, std::int16_t* out) {
  for (std::size_t cell = 0; cell < cells; ++cell)
    for (std::size_t i = 0; i < channels; ++i)
      out[cell * channels + i] = level_of(scale * log_1_plus(or_zero(in[cell * step + i]) * per_floor));
}

// Velocities keep their direction.
FRESHET_WIDE void motion_levels(const float* in, std::size_t cells, std::size_t step, std::int16_t* out) {
  for (std::size_t cell = 0; cell < cells; ++cell) {
    const float u = in[cell * step], v = in[cell * step + 1];
    const float speed = std::sqrt(u * u + v * v);
    const float levels = kLogSteps * log_1_plus(speed / kSpeedFloor);
    const float bounded = levels < kMaxLogStep ? levels : kMaxLogStep;
    const float shrink = speed > 1e-6f ? bounded / speed : kLogSteps / kSpeedFloor;
    out[2 * cell] = level_of(u * shrink);
    out[2 * cell + 1] = level_of(v * shrink);
  }
}

}  // namespace

std::array<std::size_t, kParts> part_channels(const FeatureShape& shape) {
  return {2, 2 * static_cast<std::size_t>(shape.bands), vision::kTextureLevels};
}

void find_log_features(const FeatureShape& shape, std::span<const float> features,
                       std::span<std::int16_t> log_features) {
  const auto channels = part_channels(shape);
  const auto step = static_cast<std::size_t>(shape.channels()), cells = features.size() / step;
  assert(features.size() == cells * step && log_features.size() == features.size());
  const float *bands = features.data() + channels[kMotion], *levels = bands + channels[kDynamics];
  std::int16_t* out = log_features.data();
  motion_levels(features.data(), cells, step, out);
  log_levels(bands, cells, step, channels[kDynamics], 1 / kPowerFloor, kLogSteps / 2,
             out += cells * channels[kMotion]);
  log_levels(levels, cells, step, channels[kTextureness], 1 / kTextureFloor, kLogSteps,
             out += cells * channels[kDynamics]);
}

void find_log_features(const FeatureShape& shape, std::span<const float> features,
                       std::span<float> log_features) {
  const auto channels = part_channels(shape);
  const auto step = static_cast<std::size_t>(shape.channels()), cells = features.size() / step;
  assert(features.size() == cells * step && log_features.size() == features.size());
  constexpr float kScales[] = {1 / kFrameRate, 1 / (kFrameRate * kFrameRate), 1};
  const float* from = features.data();
  float* out = log_features.data();
  for (std::size_t part = 0; part < kParts; from += channels[part++])
    for (std::size_t cell = 0; cell < cells; ++cell)
      for (std::size_t i = 0; i < channels[part]; ++i) *out++ = kScales[part] * from[cell * step + i];
}

}  // namespace freshet::query
