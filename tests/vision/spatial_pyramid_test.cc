#include "vision/spatial_pyramid.h"

#include <cstdlib>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "freshet/error.h"

namespace freshet::vision {
namespace {

WordMap random_words(std::uint64_t seed, int word_count) {
  std::mt19937_64 random(seed);
  WordMap words;
  for (auto& word : words) word = static_cast<std::uint8_t>(random() % word_count);
  return words;
}

std::map<int, int> histogram_of(const WordMap& words, int word_count) {
  std::map<int, int> histogram;
  for (int i = 0; i < 81; ++i) {
    const auto cells = cells_of(i % 9, i / 9);
    for (int level = 0; level < 3; ++level)
      histogram[cells[level] * word_count + words[i]] += kLevelWeights[level];
  }
  return histogram;
}

TEST(SpatialPyramid, CellsAreNumberedLevelByLevel) {
  EXPECT_EQ(cells_of(0, 0), (std::array<int, 3>{0, 1, 5}));
  EXPECT_EQ(cells_of(8, 0), (std::array<int, 3>{0, 2, 8}));
  EXPECT_EQ(cells_of(0, 8), (std::array<int, 3>{0, 3, 17}));
  EXPECT_EQ(cells_of(8, 8), (std::array<int, 3>{0, 4, 20}));
  EXPECT_EQ(cells_of(4, 5), (std::array<int, 3>{0, 3, 14}));
}

TEST(SpatialPyramid, L1IsTwiceTheMassLeftByTheIntersection) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const int word_count = 20;
    const WordMap a = random_words(seed, word_count), b = random_words(seed + 1000, word_count);
    auto ha = histogram_of(a, word_count), hb = histogram_of(b, word_count);
    int l1 = 0, shared = 0;
    for (int bin = 0; bin < kPyramidCells * word_count; ++bin) {
      l1 += std::abs(ha[bin] - hb[bin]);
      shared += std::min(ha[bin], hb[bin]);
    }
    EXPECT_EQ(intersection(a, b, word_count), shared);
    EXPECT_EQ(l1, 2 * (324 - shared));
    EXPECT_EQ(intersection(a, a, word_count), 324);
  }
}

TEST(SpatialPyramid, MaskedPointsDoNotCount) {
  const WordMap a = random_words(1, 50), b = random_words(2, 50);
  WordMask mask{};
  for (int i = 0; i < 81; i += 3) mask[i] = 1;
  EXPECT_EQ(intersection(a, a, 50, &mask), 27 * 4);
  EXPECT_LE(intersection(a, b, 50, &mask), intersection(a, b, 50));
  mask.fill(0);
  EXPECT_EQ(intersection(a, a, 50, &mask), 0);
}

TEST(SpatialPyramid, RefusesAWordThatTheCodebookLacks) {
  WordMap words{};
  words[40] = 200;
  EXPECT_THROW(intersection(words, words, 200), Error);
}

}  // namespace
}  // namespace freshet::vision
