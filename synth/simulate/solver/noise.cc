// synth/simulate/solver/noise.cc
#include "synth/simulate/solver/noise.h"

#include <cmath>

#include "platform/random.h"
#include "synth/field/portable_math.h"

namespace freshet::synth::simulate {

Noise::Noise(std::uint64_t seed) : values_(static_cast<std::size_t>(kSide) * kSide) {
  const Random random(seed, 0x6e6f697365);
  std::vector<Vec2> gradient(static_cast<std::size_t>(kUnits) * kUnits);
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    const float turn = random.at(i);
    gradient[i] = {cos_turns(turn), sin_turns(turn)};
  }
  const auto corner = [&](int cx, int cy, float dx, float dy) {
    const Vec2 g = gradient[static_cast<std::size_t>((cy % kUnits) * kUnits + cx % kUnits)];
    return g.x * dx + g.y * dy;
  };
  const auto fade = [](float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); };
  constexpr int kStep = kSide / kUnits;
  for_rows(kSide, [&](int y) {
    const int cy = y / kStep;
    const float fy = static_cast<float>(y % kStep) / kStep, wy = fade(fy);
    for (int x = 0; x < kSide; ++x) {
      const int cx = x / kStep;
      const float fx = static_cast<float>(x % kStep) / kStep, wx = fade(fx);
      const float top = lerp(corner(cx, cy, fx, fy), corner(cx + 1, cy, fx - 1, fy), wx);
      const float bottom = lerp(corner(cx, cy + 1, fx, fy - 1), corner(cx + 1, cy + 1, fx - 1, fy - 1), wx);
      values_[static_cast<std::size_t>(y * kSide + x)] = 1.5f * lerp(top, bottom, wy);
    }
  });
}

float Noise::fractal(float x, float y, int octaves, float gain, float lacunarity) const {
  float sum = 0.0f, amplitude = 1.0f;
  for (int i = 0; i < octaves; ++i) {
    sum += amplitude * (*this)(x, y);
    // A turn by 37 degrees hides the lattice, the shift keeps octaves from meeting at the origin.
    const float turned = 0.7986f * x - 0.6018f * y;
    y = (0.6018f * x + 0.7986f * y) * lacunarity + 7.31f;
    x = turned * lacunarity + 3.17f;
    amplitude *= gain;
  }
  return sum;
}

float Noise::changing(float x, float y, float time, int octaves, float gain) const {
  const int cut = floor_int(time);
  const float t = time - static_cast<float>(cut);
  const auto shift = [](int k, float step) {
    const float s = static_cast<float>(k) * step;
    return 32.0f * (s - static_cast<float>(floor_int(s)));
  };
  const float a = fractal(x + shift(cut, 0.6180340f), y + shift(cut, 0.7548777f), octaves, gain);
  const float b = fractal(x + shift(cut + 1, 0.6180340f), y + shift(cut + 1, 0.7548777f), octaves, gain);
  return a * cos_turns(0.25f * t) + b * sin_turns(0.25f * t);
}

}  // namespace freshet::synth::simulate
