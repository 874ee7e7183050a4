#include "query/index/dense_histogram.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/query/index/random_words.h"

namespace freshet::query {
namespace {

TEST(DenseHistogram, NearestByL1IsBestByIntersectionMaskedOrNot) {
  constexpr int kWords = 60;
  const auto rows = random_words({.rows = 60, .words = kWords, .clusters = 4, .seed = 3});
  const auto histograms = dense_histograms(rows, kWords);
  const std::size_t bins = histogram_bins(kWords);
  ASSERT_EQ(histograms.size(), rows.size() * bins);
  PieceQuery query = whole(rows[1]);
  for (const std::size_t masked : {0u, 30u, 80u}) {
    std::fill_n(query.mask.begin(), masked, std::uint8_t{0});
    std::vector<unsigned char> histogram(bins);
    fill_histogram(query, kWords, histogram);
    EXPECT_EQ(std::accumulate(histogram.begin(), histogram.end(), 0), max_score(query));
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const auto distance = l1_distance(histogram.data(), histograms.data() + row * bins, bins);
      EXPECT_EQ(static_cast<int>(score_of(max_score(query), distance)),
                vision::intersection(query.words, rows[row], kWords, &query.mask));
    }
  }
}

TEST(DenseHistogram, DistanceIsTheSumOfDifferencesForAnyLength) {
  std::vector<unsigned char> a(301), b(301);
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] = static_cast<unsigned char>(i * 37);
    b[i] = static_cast<unsigned char>(i * i);
  }
  std::uint32_t sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    EXPECT_EQ(l1_distance(a.data(), b.data(), n), sum);
    sum += static_cast<std::uint32_t>(std::abs(a[n] - b[n]));
  }
}

}  // namespace
}  // namespace freshet::query
