// synth/simulate/clips/carried_texture.h — texture that a flow carries along without ever smearing it out.
#pragma once

#include <cstdint>

#include "synth/field/grid.h"

namespace freshet::synth::simulate {

/// Texture coordinates advected with the flow (Max, Becker 1995; Neyret 2003). A coordinate map left alone is
/// stretched beyond use, so there are two, each reset every `life` frames, half a life apart, and faded in
/// and out. The weights' squares sum to 1: the contrast of the sum of two unrelated textures stays level.
class CarriedTexture {
 public:
  static constexpr int kMaps = 2;

  /// width, height   of the flow's grid.
  /// life            frames between resets, at least 2.
  /// phase           shifts the resets, frames.
  CarriedTexture(int width, int height, int life, int phase);

  /// back  where each cell's content was a frame ago, less its place, cells.
  void advance(const VectorGrid& back);

  /// Where what lies in a cell now lay when the map was reset, less its place, cells.
  const VectorGrid& offset(int map) const { return offset_[map]; }
  float weight(int map) const;
  /// The maps' textures at a place of the grid, each by its weight: sample(offset, shift) is a map's.
  template <class Sample>
  float blended(float x, float y, const Sample& sample) const {
    float sum = 0.0f;
    for (int map = 0; map < kMaps; ++map)
      sum += weight(map) * sample(bilinear(offset_[map], x, y), shift(map));
    return sum;
  }
  /// Added to the coordinates, so that a map does not bring the same texture back after its reset.
  Vec2 shift(int map) const;

 private:
  int age(int map) const { return (clock_ + map * life_ / kMaps) % life_; }
  int generation(int map) const { return (clock_ + map * life_ / kMaps) / life_ * kMaps + map; }

  int life_, clock_;
  VectorGrid offset_[kMaps], next_;
};

}  // namespace freshet::synth::simulate
