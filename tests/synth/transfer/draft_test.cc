#include "synth/transfer/draft.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace freshet::synth::transfer {
namespace {

constexpr int kWidth = 100, kHeight = 70, kTile = 16;

// Every third place, as a segment with gaps.
std::vector<int> sources() {
  std::vector<int> places;
  for (int place = 0; place < kWidth * kHeight; place += 3) places.push_back(place);
  return places;
}

std::pair<int, int> tile_of(int place) { return {place % kWidth / kTile, place / kWidth / kTile}; }

TEST(SourcePart, IsSoManyInTheirOrderOfWholeTilesButOne) {
  const std::vector<int> all = sources();
  std::map<std::pair<int, int>, int> in_tile;
  for (const int place : all) ++in_tile[tile_of(place)];
  for (const std::size_t count : {std::size_t{1}, std::size_t{500}, std::size_t{1234}, all.size()}) {
    const std::vector<int> part = part_of(all, kWidth, count, kTile, 7);
    ASSERT_EQ(part.size(), count);
    EXPECT_TRUE(std::is_sorted(part.begin(), part.end()));
    EXPECT_TRUE(std::includes(all.begin(), all.end(), part.begin(), part.end()));
    std::map<std::pair<int, int>, int> taken;
    for (const int place : part) ++taken[tile_of(place)];
    const auto cut = std::count_if(taken.begin(), taken.end(),
                                   [&](const auto& tile) { return tile.second < in_tile[tile.first]; });
    EXPECT_LE(cut, 1) << count;
  }
}

TEST(SourcePart, GrowsByWhatIsAdded) {
  std::vector<int> before;
  for (const std::size_t count : {std::size_t{10}, std::size_t{300}, std::size_t{301}, std::size_t{2000}}) {
    const std::vector<int> part = part_of(sources(), kWidth, count, kTile, 3);
    EXPECT_TRUE(std::includes(part.begin(), part.end(), before.begin(), before.end())) << count;
    before = part;
  }
}

TEST(SourcePart, LiesSpreadOverThePicture) {
  std::vector<int> all(128 * 128);
  std::iota(all.begin(), all.end(), 0);
  const std::vector<int> part = part_of(all, 128, all.size() / 4, 8, 5);
  // A tile of 8 px of every square of 16.
  std::map<int, int> in_square;
  for (const int place : part) ++in_square[place / 128 / 16 * 8 + place % 128 / 16];
  ASSERT_EQ(in_square.size(), 64u);
  for (const auto& [square, places] : in_square) EXPECT_EQ(places, 64) << square;
}

TEST(SourcePart, AnotherSeedDrawsOtherTiles) {
  EXPECT_NE(part_of(sources(), kWidth, 500, kTile, 1), part_of(sources(), kWidth, 500, kTile, 2));
}

}  // namespace
}  // namespace freshet::synth::transfer
