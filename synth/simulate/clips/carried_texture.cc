// synth/simulate/clips/carried_texture.cc
#include "synth/simulate/clips/carried_texture.h"

#include <algorithm>

#include "synth/field/portable_math.h"

namespace freshet::synth::simulate {

CarriedTexture::CarriedTexture(int width, int height, int life, int phase)
    : life_(std::max(life, 2)), clock_(phase), next_(width, height) {
  for (VectorGrid& offset : offset_) offset = VectorGrid(width, height);
}

void CarriedTexture::advance(const VectorGrid& back) {
  ++clock_;
  for (int map = 0; map < kMaps; ++map) {
    if (age(map) == 0) {
      std::fill(offset_[map].values.begin(), offset_[map].values.end(), Vec2{});
      continue;
    }
    for_rows(next_.height, [&](int y) {
      for (int x = 0; x < next_.width; ++x) {
        const Vec2 d = back(x, y);
        const Vec2 origin = bilinear(offset_[map], static_cast<float>(x) + d.x, static_cast<float>(y) + d.y);
        next_(x, y) = {origin.x + d.x, origin.y + d.y};
      }
    });
    std::swap(offset_[map], next_);
  }
}

float CarriedTexture::weight(int map) const {
  return sin_turns(0.5f * static_cast<float>(age(map)) / static_cast<float>(life_));
}

Vec2 CarriedTexture::shift(int map) const {
  const auto part = [&](float step) {
    const float s = static_cast<float>(generation(map) % 4096) * step;
    return 32.0f * (s - static_cast<float>(floor_int(s)));
  };
  return {part(0.6180340f), part(0.7548777f)};
}

}  // namespace freshet::synth::simulate
