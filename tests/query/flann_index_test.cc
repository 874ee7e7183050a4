#include "query/flann_index.h"

#include <gtest/gtest.h>

#include "freshet_error.h"
#include "query/exact_index.h"
#include "random_words.h"

namespace freshet::query {
namespace {

constexpr int kWords = 100;
constexpr std::array kKinds{FlannKind::kKdTree, FlannKind::kKMeans, FlannKind::kHierarchical};

// Share of the true k best that were found; rows as good as the worst true one count as found.
double recall(const std::vector<Hit>& found, const std::vector<Hit>& truth) {
  std::size_t good = 0;
  for (const Hit& hit : found) good += hit.score >= truth.back().score;
  return static_cast<double>(good) / static_cast<double>(truth.size());
}

TEST(FlannIndex, FindsMostOfTheBestAmongClusteredPatches) {
  const auto rows = random_words({.rows = 2000, .words = kWords, .clusters = 20, .seed = 2});
  std::vector<PieceQuery> queries;
  for (std::size_t i = 0; i < 20; ++i) queries.push_back(whole(rows[i * 100]));
  const auto masked = [](std::size_t i) { return i % 2 == 0; };
  for (std::size_t i = 0; i < 20; ++i) {
    for (std::size_t point = 0; masked(i) && point < 27; ++point) queries[i].mask[point] = 0;
  }
  const auto truth = ExactIndex(rows, kWords).search(queries, 20);
  for (const FlannKind kind : kKinds) {
    const FlannIndex index(rows, kWords, {.kind = kind, .checks = 500});
    const auto answers = index.search(queries, 20);
    double sum = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      ASSERT_EQ(answers[i].size(), 20u);
      // A whole query is a row itself, and the first descent of every tree ends there. A masked one lies
      // elsewhere: FLANN may miss the best row, and as its trees differ from run to run, sometimes does.
      if (!masked(i)) {
        EXPECT_EQ(answers[i][0], truth[i][0]) << name_of(kind);
      }
      for (const Hit& hit : answers[i]) {
        EXPECT_EQ(static_cast<int>(hit.score),
                  vision::intersection(queries[i].words, rows[hit.row], kWords, &queries[i].mask));
      }
      sum += recall(answers[i], truth[i]);
    }
    EXPECT_GT(sum / static_cast<double>(queries.size()), 0.5) << name_of(kind);
  }
}

TEST(FlannIndex, AnswersTheSameAfterSavingAndLoading) {
  const auto rows = random_words({.rows = 800, .words = kWords, .clusters = 20, .seed = 3});
  std::vector<PieceQuery> queries;
  for (std::size_t i = 0; i < 10; ++i) queries.push_back(whole(rows[i * 70]));
  for (const FlannKind kind : kKinds) {
    const FlannOptions options{.kind = kind, .checks = 200};
    const FlannIndex built(rows, kWords, options);
    const FlannIndex loaded(rows, kWords, built.serialize(), options);
    for (const std::size_t k : {1u, 100u, 250u, 251u}) {
      EXPECT_EQ(loaded.search(queries, k), built.search(queries, k)) << name_of(kind) << " " << k;
    }
  }
}

TEST(FlannIndex, AsksForNoMoreRowsThanThereAre) {
  const auto rows = random_words({.rows = 300, .words = kWords});
  for (const FlannKind kind : kKinds) {
    const FlannIndex index(rows, kWords, {.kind = kind});
    for (const std::size_t k : {299u, 300u, 301u, 10000u}) {
      const auto answer = index.search(std::vector{whole(rows[0])}, k)[0];
      EXPECT_LE(answer.size(), std::min<std::size_t>(k, 300));
      EXPECT_GT(answer.size(), 250u) << name_of(kind);
      for (const Hit& hit : answer) EXPECT_LT(hit.row, 300u);
    }
  }
}

TEST(FlannIndex, AnswersWithAllowedRowsOnly) {
  const auto rows = random_words({.rows = 2000, .words = kWords, .clusters = 20});
  RowFilter filter(rows.size());
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (row % 4 != 0) filter.forbid(row);
  }
  const FlannIndex index(rows, kWords);
  const auto answer = index.search(std::vector{whole(rows[8])}, 50, {.rows = &filter})[0];
  EXPECT_EQ(answer.size(), 50u);
  EXPECT_EQ(answer[0], (Hit{8, 324}));
  for (const Hit& hit : answer) EXPECT_EQ(hit.row % 4, 0u);
}

ErrorKind kind_of_error(std::span<const vision::WordMap> rows, std::span<const std::byte> bytes) {
  try {
    const FlannIndex index(rows, kWords, bytes);
  } catch (const Error& error) {
    return error.kind();
  }
  ADD_FAILURE() << "accepted";
  return ErrorKind::kUsage;
}

TEST(FlannIndex, RefusesBytesThatAreNotItsOwn) {
  auto rows = random_words({.rows = 400, .words = kWords});
  const std::vector<std::byte> bytes = FlannIndex(rows, kWords).serialize();
  for (std::size_t at = 0; at < bytes.size(); at += 1 + bytes.size() / 300) {
    auto flipped = bytes;
    flipped[at] ^= std::byte{4};
    EXPECT_EQ(kind_of_error(rows, flipped), ErrorKind::kDamaged) << at;
    EXPECT_EQ(kind_of_error(rows, std::span(bytes).first(at)), ErrorKind::kDamaged) << at;
  }
  rows[3][3] ^= 1;
  EXPECT_EQ(kind_of_error(rows, bytes), ErrorKind::kDamaged);
}

TEST(FlannIndex, SaysWhatToDoWhenItWouldTakeTooMuchMemory) {
  const auto rows = random_words({.rows = 1000, .words = kWords});
  try {
    FlannIndex(rows, kWords, {.max_bytes = 1 << 20});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    EXPECT_NE(std::string(error.what()).find("exact index"), std::string::npos);
  }
}

TEST(FlannIndex, AcceptsNoRows) {
  const std::vector<vision::WordMap> none;
  const FlannIndex index(none, kWords);
  EXPECT_TRUE(index.search(std::vector{PieceQuery{}}, 5)[0].empty());
  EXPECT_EQ(FlannIndex(none, kWords, index.serialize()).rows(), 0u);
}

}  // namespace
}  // namespace freshet::query
