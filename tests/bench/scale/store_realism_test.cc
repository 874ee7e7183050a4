#include "bench/scale/store_realism.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "freshet/error.h"
#include "query/index/exact_index.h"

namespace freshet::bench {
namespace {

constexpr int kWords = 40;

std::vector<vision::WordMap> random_words(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<vision::WordMap> words(count);
  for (vision::WordMap& map : words) {
    for (std::uint8_t& word : map) word = static_cast<std::uint8_t>(random() % kWords);
  }
  return words;
}

TEST(StoreRealism, SharesAndTheirDistances) {
  std::vector<vision::WordMap> words(2);
  words[0].fill(0);
  words[1].fill(3);
  const auto fractions = word_fractions(words, 4);
  EXPECT_EQ(fractions, (std::vector<double>{0.5, 0, 0, 0.5}));
  const std::vector<double> other{0.25, 0.25, 0, 0.5};
  EXPECT_DOUBLE_EQ(total_variation(fractions, other), 0.25);
  EXPECT_DOUBLE_EQ(divergence_bits(fractions, other), 0.5);
  EXPECT_DOUBLE_EQ(divergence_bits(fractions, fractions), 0);
}

TEST(StoreRealism, APatchOfOneWordHasABinACell) {
  std::vector<vision::WordMap> words(1);
  words[0].fill(7);
  EXPECT_DOUBLE_EQ(mean_bins(words, kWords), vision::kPyramidCells);
}

TEST(StoreRealism, NeighboursAreThoseThatComparingWithAllGives) {
  const auto words = random_words(300, 1), asked = random_words(4, 2);
  const query::ExactIndex index(words, kWords);
  std::vector<query::PieceQuery> queries;
  NeighbourScores expected;
  for (const vision::WordMap& map : asked) {
    queries.push_back(query_of(map));
    std::vector<int> scores;
    for (const vision::WordMap& other : words) scores.push_back(vision::intersection(map, other, kWords));
    std::sort(scores.rbegin(), scores.rend());
    expected.first += scores[0] / 324.0 / 4;
    expected.tenth += scores[9] / 324.0 / 4;
    expected.hundredth += scores[99] / 324.0 / 4;
  }
  const NeighbourScores found = neighbour_scores(index, queries);
  EXPECT_NEAR(found.first, expected.first, 1e-12);
  EXPECT_NEAR(found.tenth, expected.tenth, 1e-12);
  EXPECT_NEAR(found.hundredth, expected.hundredth, 1e-12);
}

TEST(StoreRealism, BestScoresKeepToTheAllowedRows) {
  const auto words = random_words(50, 3);
  const query::ExactIndex index(words, kWords);
  const std::vector<query::PieceQuery> queries{query_of(words[7])};
  query::RowFilter all(words.size()), others(words.size());
  others.forbid(7);
  EXPECT_DOUBLE_EQ(best_scores(index, queries, all)[0], 1);
  EXPECT_LT(best_scores(index, queries, others)[0], 0.6);
}

TEST(StoreRealism, TooFewPatchesAreAnError) {
  const auto words = random_words(50, 3);
  const std::vector<query::PieceQuery> queries{query_of(words[0])};
  EXPECT_THROW(neighbour_scores(query::ExactIndex(words, kWords), queries), Error);
}

}  // namespace
}  // namespace freshet::bench
