#include "query/index/exact_index.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>

#include "freshet/error.h"
#include "tests/harness/fault.h"
#include "tests/query/index/random_words.h"

namespace freshet::query {
namespace {

std::vector<PieceQuery> some_queries(vision::WordMaps rows, int words) {
  std::vector<PieceQuery> queries;
  for (std::size_t i = 0; i < 6; ++i) queries.push_back(whole(rows[i * rows.size() / 6]));
  const auto strangers = random_words({.rows = 6, .words = words, .seed = 77});
  std::mt19937_64 random(5);
  for (std::size_t i = 0; i < strangers.size(); ++i) {
    queries.push_back(whole(strangers[i]));
    queries.push_back(queries[i]);
    for (auto& counts : queries.back().mask) counts = random() % 3 != 0;
  }
  return queries;
}

TEST(ExactIndex, FindsWhatComparingEveryRowFindsInTheSameOrder) {
  for (const int words : {1, 7, 200, 256, 257, 500, vision::kMaxWords}) {
    const auto rows = random_words({.rows = 1000, .words = words, .clusters = 10, .seed = 4});
    const ExactIndex index(rows, words);
    RowFilter filter(rows.size());
    for (std::size_t row = 0; row < rows.size(); ++row) {
      if (row % 3 == 0 || (row > 300 && row < 500)) filter.forbid(row);
    }
    const auto queries = some_queries(rows, words);
    for (const std::size_t k : {1u, 100u, 999u, 1000u, 5000u}) {
      const auto all = index.search(queries, k), some = index.search(queries, k, {.rows = &filter});
      for (std::size_t i = 0; i < queries.size(); ++i) {
        EXPECT_EQ(all[i], brute_force(rows, words, queries[i], k));
        EXPECT_EQ(some[i], brute_force(rows, words, queries[i], k, &filter));
      }
    }
  }
}

// Windows hold inside the search: the answer is brute force's over the rows that each query's window admits.
TEST(ExactIndex, GivesEachQueryTheRowsThatMoveAsItsWindowSays) {
  const auto rows = random_words({.rows = 40000, .words = 30, .clusters = 10, .seed = 14});
  const ExactIndex index(rows, 30);
  std::vector<float> u, v;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    u.push_back(static_cast<float>(row % 97) * std::cos(static_cast<float>(row)));
    v.push_back(static_cast<float>(row % 97) * std::sin(static_cast<float>(row)));
  }
  RowFilter filter(rows.size());
  for (std::size_t row = 0; row < rows.size(); row += 5) filter.forbid(row);
  const auto queries = some_queries(rows, 30);
  std::vector<MotionWindow> windows(queries.size());
  for (std::size_t i = 1; i < windows.size(); ++i) {          // the first stays open
    windows[i].min_speed = 3 * static_cast<float>(i) - 0.5f;  // between the speeds that there are
    windows[i].max_speed = 5 * static_cast<float>(i) + 0.5f;
    if (i % 2 == 0) continue;
    windows[i].u = std::cos(static_cast<float>(i));
    windows[i].v = std::sin(static_cast<float>(i));
    windows[i].min_cosine = 0.9f;
  }
  const auto answers =
      index.search(queries, 100, {.rows = &filter, .mean_u = u, .mean_v = v, .windows = windows});
  for (std::size_t i = 0; i < queries.size(); ++i) {
    RowFilter admitted = filter;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const double speed = std::hypot(u[row], v[row]);
      const double along = u[row] * windows[i].u + v[row] * windows[i].v;
      const bool in = i == 0 || (speed >= windows[i].min_speed && speed <= windows[i].max_speed &&
                                 (i % 2 == 0 || along >= 0.9 * speed));
      if (!in) admitted.forbid(row);
    }
    EXPECT_GE(answers[i].size(), 50u);
    EXPECT_EQ(answers[i], brute_force(rows, 30, queries[i], 100, &admitted)) << i;
  }
}

TEST(ExactIndex, CrossesTheBordersOfBlocks) {
  for (const int words : {40, 500}) {
    const auto rows = random_words({.rows = 70001, .words = words, .clusters = 30, .seed = 8});
    const ExactIndex index(rows, words);
    RowFilter last_block(rows.size(), false);
    for (std::size_t row = 65536; row < rows.size(); ++row) last_block.allow(row);
    const std::vector<PieceQuery> queries{whole(rows[0]), whole(rows[32767]), whole(rows[32768]),
                                          whole(rows[70000])};
    const auto answers = index.search(queries, 150),
               filtered = index.search(queries, 150, {.rows = &last_block});
    for (std::size_t i = 0; i < queries.size(); ++i) {
      EXPECT_EQ(answers[i], brute_force(rows, words, queries[i], 150));
      EXPECT_EQ(filtered[i], brute_force(rows, words, queries[i], 150, &last_block));
    }
  }
}

TEST(ExactIndex, AnswersTheSameForAnyNumberOfThreads) {
  const auto rows = random_words({.rows = 40000, .words = 50, .clusters = 20});
  const auto queries = some_queries(rows, 50);
  std::vector<std::vector<ScoredPatch>> reference;
  for (const int threads : {1, 2, 8}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    const auto answers = ExactIndex(rows, 50).search(queries, 100);
    if (reference.empty()) reference = answers;
    EXPECT_EQ(answers, reference);
  }
}

TEST(ExactIndex, GivesTheFullMassToARowItself) {
  const auto rows = random_words({.rows = 500});
  const auto answers = ExactIndex(rows, 200).search(std::vector{whole(rows[0])}, 1);
  ASSERT_EQ(answers[0].size(), 1u);
  EXPECT_EQ(answers[0][0], (ScoredPatch{0, 324}));
}

TEST(ExactIndex, AcceptsNoRowsNoQueriesAndNothingAllowed) {
  const ExactIndex empty(vision::WordMaps{}, 200);
  const auto rows = random_words({.rows = 10});
  EXPECT_TRUE(empty.search(std::vector{whole(rows[0])}, 5)[0].empty());
  const ExactIndex index(rows, 200);
  EXPECT_TRUE(index.search({}, 5).empty());
  const RowFilter nothing(rows.size(), false);
  EXPECT_TRUE(index.search(std::vector{whole(rows[0])}, 5, {.rows = &nothing})[0].empty());
}

TEST(ExactIndex, RefusesWordsThatTheCodebookLacks) {
  for (const int words : {50, 500}) {
    auto rows = random_words({.rows = 10, .words = words});
    vision::WordMap map = rows[7];
    map[80] = static_cast<vision::Word>(words);
    rows.set(7, map);
    const std::string fault = fault_of(ErrorKind::kDamaged, [&] { ExactIndex(rows, words); });
    EXPECT_NE(fault.find("row 7"), std::string::npos);
  }
}

TEST(RowFilter, CountsOnlyTheRowsThereAre) {
  RowFilter filter(130);
  EXPECT_EQ(filter.count(), 130u);
  filter.forbid(129);
  filter.forbid(0);
  EXPECT_EQ(filter.count(), 128u);
  EXPECT_FALSE(filter.allows(0));
  EXPECT_FALSE(filter.empty(0, 64));
  for (std::size_t row = 0; row < 64; ++row) filter.forbid(row);
  EXPECT_TRUE(filter.empty(0, 64));
  EXPECT_FALSE(filter.empty(64, 66));
}

}  // namespace
}  // namespace freshet::query
