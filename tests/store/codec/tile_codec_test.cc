#include "store/codec/tile_codec.h"

#include <gtest/gtest.h>

#include "store/codec/zstd_context.h"
#include "store/records/record.h"
#include "store/records/tile_record.h"
#include "tests/store/clip_samples.h"

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

// A flipped bit is an error or makes no difference.
TEST(TileCodec, DamagedTilesNeverDecodeToOtherSamples) {
  std::mt19937_64 random(13);
  for (const std::uint8_t bytes : {1, 2}) {
    const TileBox box = box_of(33, 40, 9, bytes);
    const Samples samples = moving_plane({33, 40, bytes}, 9, 5);
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
}

// A frame that fits its checksum and says anything whatever: it is refused or decodes, and nothing beyond the
// samples is written. The address sanitizer sees what is read.
TEST(TileCodec, HostileContentNeverLeavesItsMemory) {
  std::mt19937_64 random(17);
  constexpr std::byte kGuard{0xa5};
  constexpr std::size_t kGuards = 256;
  int refused = 0;
  for (const std::uint8_t bytes : {1, 2}) {
    const TileBox box = box_of(37, 21, 5, bytes);
    Samples samples = moving_plane({37, 21, bytes}, 5, 6);
    for (std::size_t i = 0; i < samples.size(); i += 50) samples[i] = static_cast<std::byte>(random());
    Bytes coded;
    encode_tile(box, samples, coded);
    Bytes content(ZSTD_getFrameContentSize(coded.data(), coded.size()));
    ASSERT_TRUE(zstd_expand(coded, content));
    for (int i = 0; i < 4000; ++i) {
      Bytes hostile = content;
      // The head and the predictors, or anywhere.
      const std::size_t reach = i % 2 == 0 ? std::min<std::size_t>(hostile.size(), 150) : hostile.size();
      for (int k = 0; k <= i % 3; ++k) hostile[random() % reach] = static_cast<std::byte>(random());
      if (i % 8 == 0) hostile.resize(random() % hostile.size());
      Bytes back(samples.size() + kGuards, kGuard);
      refused += !decode_tile(box, zstd_compress(hostile, 1), std::span(back).first(samples.size()));
      ASSERT_TRUE(std::ranges::all_of(std::span(back).subspan(samples.size()),
                                      [&](std::byte byte) { return byte == kGuard; }));
    }
  }
  EXPECT_GT(refused, 4000);
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
