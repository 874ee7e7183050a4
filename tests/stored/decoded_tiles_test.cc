#include "stored/decoded_tiles.h"

#include <algorithm>
#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/parallel_for.h>

#include "tests/synth/animate/flowing_clip.h"

namespace freshet::stored {
namespace {

constexpr std::size_t kPlenty = std::size_t{1} << 30;

struct Part {
  store::Stream stream;
  std::uint32_t plane;
  store::Rect region;
  std::uint32_t first, count;
  std::size_t bytes;
};

Part random_part(const store::ClipRecord& record, std::mt19937& draw) {
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(draw() % n); };
  Part part{.stream = below(2) == 0 ? store::Stream::kFrames : store::Stream::kFlow,
            .plane = 0,
            .region = {},
            .first = 0,
            .count = 0,
            .bytes = 0};
  const store::StreamShape& stream = part.stream == store::Stream::kFlow ? record.flow : record.frames;
  part.plane = below(static_cast<std::uint32_t>(stream.planes.size()));
  const store::PlaneShape& plane = stream.planes[part.plane];
  part.region.x = below(plane.width);
  part.region.y = below(plane.height);
  part.region.width = 1 + below(plane.width - part.region.x);
  part.region.height = 1 + below(plane.height - part.region.y);
  part.first = below(stream.frames);
  part.count = 1 + below(stream.frames - part.first);
  part.bytes = std::size_t{part.region.width} * part.region.height * part.count * plane.bytes_per_sample;
  return part;
}

void expect_as_the_snapshot(const synth::animate::FlowingStore& store, DecodedTiles& tiles,
                            std::uint32_t seed) {
  std::mt19937 draw(seed);
  const Part part = random_part(store.snapshot().clip(store.id()), draw);
  std::vector<std::byte> expected(part.bytes), found(part.bytes);
  store.snapshot().read(store.id(), part.stream, part.plane, part.region, part.first, part.count, expected);
  tiles.read(store.id(), part.stream, part.plane, part.region, part.first, part.count, found);
  EXPECT_EQ(found, expected) << seed;
}

TEST(DecodedTiles, AreReadAsFromTheSnapshot) {
  const synth::animate::FlowingStore store({synth::animate::FlowingClip{}});
  DecodedTiles tiles(store.snapshot(), kPlenty);
  for (std::uint32_t seed = 0; seed < 60; ++seed) expect_as_the_snapshot(store, tiles, seed);
}

TEST(DecodedTiles, AreReadByManyThreadsAtOnce) {
  const synth::animate::FlowingStore store({synth::animate::FlowingClip{}});
  DecodedTiles tiles(store.snapshot(), 100000);
  oneapi::tbb::parallel_for(0u, 60u, [&](std::uint32_t seed) { expect_as_the_snapshot(store, tiles, seed); });
}

TEST(DecodedTiles, HoldNoMoreThanTheyMay) {
  const synth::animate::FlowingStore store({synth::animate::FlowingClip{}});
  DecodedTiles tiles(store.snapshot(), 100000);
  std::size_t most = 0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    expect_as_the_snapshot(store, tiles, seed);
    most = std::max(most, tiles.bytes());
  }
  EXPECT_GT(most, 0u);
  EXPECT_LE(most, 100000u);
}

TEST(DecodedTiles, AreKept) {
  const synth::animate::FlowingStore store({synth::animate::FlowingClip{}});
  DecodedTiles tiles(store.snapshot(), kPlenty);
  for (std::uint32_t seed = 0; seed < 60; ++seed) expect_as_the_snapshot(store, tiles, seed);
  const std::size_t held = tiles.bytes();
  for (std::uint32_t seed = 0; seed < 60; ++seed) expect_as_the_snapshot(store, tiles, seed);
  EXPECT_EQ(tiles.bytes(), held);
}

}  // namespace
}  // namespace freshet::stored
