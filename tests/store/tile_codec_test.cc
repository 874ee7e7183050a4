#include "store/tile_codec.h"

#include <gtest/gtest.h>

#include "clip_samples.h"
#include "store/record.h"
#include "store/tile_record.h"

namespace freshet::store {
namespace {

TileBox box_of(std::uint32_t width, std::uint32_t height, std::uint32_t frames, std::uint8_t bytes) {
  TileBox box;
  box.width = width;
  box.height = height;
  box.frames = frames;
  box.bytes_per_sample = bytes;
  return box;
}

TEST(TileCodec, GivesBackTilesOfAnyShapeAndContent) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 300; ++i) {
    const TileBox box =
        box_of(1 + static_cast<std::uint32_t>(random() % 64), 1 + static_cast<std::uint32_t>(random() % 64),
               1 + static_cast<std::uint32_t>(random() % 16), static_cast<std::uint8_t>(1 + random() % 2));
    Samples samples = moving_plane({box.width, box.height, box.bytes_per_sample}, box.frames, random());
    // Noise of every sample size, extremes, and constants.
    if (i % 4 == 1) std::ranges::generate(samples, [&] { return static_cast<std::byte>(random()); });
    if (i % 4 == 2)
      std::ranges::generate(samples, [&] { return static_cast<std::byte>(random() % 2 * 255); });
    if (i % 4 == 3) std::ranges::fill(samples, static_cast<std::byte>(i));
    Bytes coded, back(samples.size());
    encode_tile(box, samples, coded);
    ASSERT_TRUE(decode_tile(box, coded, back)) << i;
    ASSERT_EQ(back, samples) << i;
  }
}

TEST(TileCodec, MovingWavesTakeLessThanHalfAndStillOnesAHundredth) {
  const TileBox box = box_of(64, 64, 16, 1);
  const Samples moving = moving_plane({64, 64, 1}, 16, 4), still(box.bytes(), std::byte{90});
  Bytes coded;
  encode_tile(box, moving, coded);
  EXPECT_LT(coded.size(), moving.size() / 2);
  coded.clear();
  encode_tile(box, still, coded);
  EXPECT_LT(coded.size(), still.size() / 100);
}

// A flipped bit is an error or makes no difference, and a hostile frame never leaves its memory.
TEST(TileCodec, DamagedTilesNeverDecodeToOtherSamples) {
  std::mt19937_64 random(13);
  const TileBox box = box_of(33, 40, 9, 1);
  const Samples samples = moving_plane({33, 40, 1}, 9, 5);
  Bytes coded, back(samples.size());
  encode_tile(box, samples, coded);
  for (int i = 0; i < 4000; ++i) {
    Bytes damaged = coded;
    damaged[random() % damaged.size()] ^= static_cast<std::byte>(1u << random() % 8);
    if (i % 4 == 0) damaged.resize(random() % damaged.size());
    if (decode_tile(box, damaged, back)) {
      EXPECT_EQ(back, samples);
    }
  }
}

TEST(TileCodec, TilesOfAnotherShapeAreRefused) {
  const TileBox box = box_of(32, 32, 16, 1), other = box_of(32, 31, 16, 1), deeper = box_of(16, 32, 16, 2);
  Bytes coded, back(other.bytes()), same(box.bytes());
  encode_tile(box, moving_plane({32, 32, 1}, 16, 5), coded);
  EXPECT_FALSE(decode_tile(other, coded, back));
  EXPECT_FALSE(decode_tile(deeper, coded, same));
  EXPECT_FALSE(decode_tile(box, {}, same));
}

TEST(TileGrid, RegionsTouchOnlyTheTilesThatTheyCover) {
  const std::vector<PlaneShape> planes = {{200, 150, 1}, {100, 75, 1}};
  const TileGrid grid({planes, 40}, TileGrid::default_edges(planes));
  EXPECT_EQ(grid.tiles_per_slab(), 4u * 3 + 4 * 3);
  EXPECT_EQ(grid.tile_count(), 3u * 24);
  EXPECT_EQ(grid.touched(0, {0, 0, 64, 64}, 0, 16), (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(grid.touched(0, {63, 0, 2, 1}, 15, 2), (std::vector<std::uint32_t>{0, 1, 24, 25}));
  EXPECT_EQ(grid.touched(1, {99, 74, 1, 1}, 39, 1), (std::vector<std::uint32_t>{48 + 23}));
  EXPECT_TRUE(grid.touched(0, {3, 3, 0, 5}, 0, 16).empty());
  for (std::uint32_t t = 0; t < grid.tile_count(); ++t) {
    const TileBox box = grid.box(t);
    EXPECT_EQ(grid.touched(box.plane, {box.x, box.y, box.width, box.height}, box.first_frame, box.frames),
              (std::vector<std::uint32_t>{t}));
  }
}

}  // namespace
}  // namespace freshet::store
