#include "synth/simulate/clips/carried_texture.h"

#include <gtest/gtest.h>

namespace freshet::synth::simulate {
namespace {

TEST(CarriedTexture, TravelsWithAUniformFlow) {
  CarriedTexture texture(32, 24, 40, 0);
  const VectorGrid back(32, 24, {-1.5f, 0.25f});  // the flow goes right and slowly up
  for (int i = 0; i < 10; ++i) texture.advance(back);
  const Vec2 origin = texture.offset(0)(20, 12);
  EXPECT_NEAR(origin.x, -15.0f, 1e-3f);
  EXPECT_NEAR(origin.y, 2.5f, 1e-3f);
}

TEST(CarriedTexture, KeepsItsContrastAndShowsNoMapWhenItIsReset) {
  CarriedTexture texture(8, 8, 20, 3);
  const VectorGrid back(8, 8, {-1.0f, 0.0f});
  Vec2 before[2] = {texture.shift(0), texture.shift(1)};
  for (int i = 0; i < 100; ++i) {
    texture.advance(back);
    float squares = 0.0f;
    for (int map = 0; map < CarriedTexture::kMaps; ++map) {
      squares += texture.weight(map) * texture.weight(map);
      const bool reset = texture.shift(map).x != before[map].x;
      EXPECT_EQ(reset, texture.offset(map)(4, 4).x == 0.0f);
      if (reset) {
        EXPECT_NEAR(texture.weight(map), 0.0f, 1e-3f);
      }
      before[map] = texture.shift(map);
    }
    EXPECT_NEAR(squares, 1.0f, 1e-3f);
  }
}

}  // namespace
}  // namespace freshet::synth::simulate
