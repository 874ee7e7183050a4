#include "query/index/flann_index.h"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <cstring>
#include <random>

#include "freshet/error.h"
#include "query/index/exact_index.h"
#include "query/index/flann_tuning.h"
#include "tests/harness/fault.h"
#include "tests/query/index/random_words.h"

namespace freshet::query {
namespace {

constexpr int kWords = 100;
constexpr std::array kKinds{FlannKind::kKdTree, FlannKind::kKMeans, FlannKind::kHierarchical};

// Fraction of the true k best that were found; rows as good as the worst true one count as found.
double recall(const std::vector<ScoredPatch>& found, const std::vector<ScoredPatch>& truth) {
  std::size_t good = 0;
  for (const ScoredPatch& scored : found) good += scored.score >= truth.back().score;
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
      // elsewhere: FLANN may miss the best row.
      if (!masked(i)) {
        EXPECT_EQ(answers[i][0], truth[i][0]) << name_of(kind);
      }
      for (const ScoredPatch& scored : answers[i]) {
        EXPECT_EQ(static_cast<int>(scored.score),
                  vision::intersection(queries[i].words, rows[scored.row], kWords, &queries[i].mask));
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

TEST(FlannIndex, IsTheSameWhenBuiltAgainAndAnotherWithAnotherSeed) {
  const auto rows = random_words({.rows = 700, .words = kWords, .clusters = 60, .noise = 0.8, .seed = 5});
  std::vector<PieceQuery> queries;
  for (std::size_t i = 0; i < 30; ++i) queries.push_back(whole(rows[i * 20]));
  struct Built {
    std::vector<std::byte> bytes;
    std::vector<std::vector<ScoredPatch>> answers;
  };
  const auto build = [&](FlannKind kind, std::uint32_t seed) {
    const FlannIndex index(rows, kWords, {.kind = kind, .seed = seed, .checks = 100});
    auto bytes = index.serialize();
    bytes.erase(bytes.begin(), bytes.begin() + 64);  // has the seconds that it took
    return Built{std::move(bytes), index.search(queries, 50)};
  };
  for (const FlannKind kind : kKinds) {
    const Built once = build(kind, 7), again = build(kind, 7), other = build(kind, 8);
    EXPECT_TRUE(once.answers == again.answers) << name_of(kind);
    EXPECT_FALSE(once.answers == other.answers) << name_of(kind);
    // FLANN also writes a number in kdtree's leaves that it never sets and never reads.
    if (kind != FlannKind::kKdTree) {
      EXPECT_TRUE(once.bytes == again.bytes) << name_of(kind);
    }
  }
}

TEST(FlannIndex, LooksAtMorePatchesWithMoreChecks) {
  const auto rows = random_words({.rows = 2000, .words = kWords, .clusters = 60, .noise = 0.7, .seed = 6});
  std::vector<PieceQuery> queries;
  for (std::size_t i = 0; i < 20; ++i) {
    queries.push_back(whole(rows[i * 100]));
    for (std::size_t point = 0; point < 40; ++point) queries[i].mask[point] = 0;
  }
  const auto truth = ExactIndex(rows, kWords).search(queries, 50);
  for (const FlannKind kind : kKinds) {
    FlannIndex index(rows, kWords, {.kind = kind});
    std::vector<double> fractions;
    for (const int checks : {50, 400, 2000}) {
      index.set_checks(checks);
      const auto answers = index.search(queries, 50);
      double sum = 0;
      for (std::size_t i = 0; i < queries.size(); ++i) sum += recall(answers[i], truth[i]);
      fractions.push_back(sum / static_cast<double>(queries.size()));
    }
    EXPECT_LT(fractions[0], fractions[1]) << name_of(kind);
    EXPECT_LT(fractions[1], fractions[2]) << name_of(kind);
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
      for (const ScoredPatch& scored : answer) EXPECT_LT(scored.row, 300u);
    }
  }
}

TEST(FlannIndex, GivesAllKAdmittedRowsHoweverFewTheyAre) {
  const auto rows = random_words({.rows = 2000, .words = kWords, .clusters = 20});
  std::vector<PieceQuery> queries;
  for (std::size_t i = 0; i < 3; ++i) queries.push_back(whole(rows[i * 600]));
  for (const FlannKind kind : kKinds) {
    const FlannIndex index(rows, kWords, {.kind = kind, .checks = 300});
    for (const std::size_t every : {2u, 10u, 100u, 200u}) {
      RowFilter filter(rows.size(), false);
      for (std::size_t row = 0; row < rows.size(); row += every) filter.allow(row);
      const SearchFilter search_filter{.rows = &filter};
      const std::size_t allowed = filter.count();
      const auto truth = ExactIndex(rows, kWords).search(queries, 50, search_filter);
      const auto answers = index.search(queries, 50, search_filter);
      double sum = 0;
      for (std::size_t i = 0; i < queries.size(); ++i) {
        EXPECT_EQ(answers[i].size(), truth[i].size()) << name_of(kind) << ", one row in " << every;
        EXPECT_EQ(answers[i][0], truth[i][0]) << name_of(kind) << ", one row in " << every;
        for (const ScoredPatch& scored : answers[i]) EXPECT_TRUE(filter.allows(scored.row));
        sum += recall(answers[i], truth[i]);
      }
      EXPECT_GT(sum / 3, allowed <= 50 ? 0.99 : 0.3) << name_of(kind) << ", one row in " << every;
    }
  }
}

TEST(FlannIndex, KeepsAPiecesWindowOfMotion) {
  const auto rows = random_words({.rows = 1000, .words = kWords, .clusters = 20});
  std::vector<float> u(rows.size()), v(rows.size());
  for (std::size_t row = 0; row < rows.size(); ++row) (row % 5 == 0 ? u : v)[row] = 10;
  const std::vector<PieceQuery> queries{whole(rows[5]), whole(rows[5])};
  const std::vector<MotionWindow> windows{{.u = 1, .min_cosine = 0.9F}, {}};
  const FlannIndex index(rows, kWords);
  const auto answers =
      index.search(queries, 60, {.rows = nullptr, .mean_u = u, .mean_v = v, .windows = windows});
  ASSERT_EQ(answers[0].size(), 60u);
  for (const ScoredPatch& scored : answers[0]) EXPECT_EQ(scored.row % 5, 0u);
  EXPECT_EQ(answers[1].size(), 60u);
  EXPECT_TRUE(std::any_of(answers[1].begin(), answers[1].end(),
                          [](const ScoredPatch& scored) { return scored.row % 5 != 0; }));
}

TEST(FlannTuning, FindsChecksThatReachTheRecallAmongOtherClipsAndKeepsThem) {
  const auto rows = random_words({.rows = 2000, .words = kWords, .clusters = 30, .noise = 0.6, .seed = 9});
  const std::vector<stored::Row> clips{0, 500, 500, 1250, 2000};
  for (const FlannKind kind : {FlannKind::kKMeans, FlannKind::kHierarchical}) {
    FlannIndex index(rows, kWords, {.kind = kind});
    tune_flann(index, rows, kWords, clips);
    EXPECT_GE(index.tuning().recall, 0.9F);
    EXPECT_GT(index.tuning().checks, 63u);
    EXPECT_LT(index.tuning().checks, 2000u);
    EXPECT_GT(index.tuning().build_seconds, 0);
    const FlannIndex loaded(rows, kWords, index.serialize(), {.kind = kind});
    EXPECT_EQ(loaded.tuning().checks, index.tuning().checks);
    EXPECT_EQ(loaded.tuning().recall, index.tuning().recall);
    // With no checks given, it answers as with those it was tuned to.
    const FlannIndex tuned(rows, kWords, index.serialize(),
                           {.kind = kind, .checks = static_cast<int>(index.tuning().checks)});
    const std::vector<PieceQuery> queries{whole(rows[7]), whole(rows[1700])};
    EXPECT_EQ(loaded.search(queries, 100), tuned.search(queries, 100));
  }
}

TEST(FlannTuning, TakesStoresOfOneClipAndOfFewRows) {
  for (const std::size_t count : {1u, 5u, 70u}) {
    const auto rows = random_words({.rows = count, .words = kWords});
    FlannIndex index(rows, kWords);
    tune_flann(index, rows, kWords, std::vector<stored::Row>{0, static_cast<stored::Row>(count)});
    EXPECT_GE(index.tuning().recall, 0.9F) << count;
  }
}

std::optional<ErrorKind> kind_of_error(vision::WordMaps rows, std::span<const std::byte> bytes) {
  return kind_of([&] { FlannIndex(rows, kWords, bytes); });
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
  rows.bytes()[3 * 81 + 3] ^= std::byte{1};
  EXPECT_EQ(kind_of_error(rows, bytes), ErrorKind::kDamaged);
}

// A header of 64 bytes, in which the hash and the size of the rest stand from byte 32 on.
void seal(std::vector<std::byte>& bytes) {
  const std::uint64_t size = bytes.size() - 64, hash = XXH3_64bits(bytes.data() + 64, size);
  std::memcpy(&bytes[32], &hash, 8);
  std::memcpy(&bytes[40], &size, 8);
}

// Whoever makes a store computes its hashes.
TEST(FlannIndex, WalksTreesThatAreGarbledAndSealedAgain) {
  const auto rows = random_words({.rows = 200, .words = kWords, .clusters = 20, .seed = 4});
  const std::vector<PieceQuery> queries{whole(rows[0]), whole(rows[150])};
  std::mt19937 random(12);
  for (const FlannKind kind : kKinds) {
    const FlannOptions options{.kind = kind, .branching = 8, .checks = 150};
    const std::vector<std::byte> built = FlannIndex(rows, kWords, options).serialize();
    int refused = 0, taken = 0;
    for (int round = 0; round < 700; ++round) {
      std::vector<std::byte> bytes = built;
      // Half of them among the counts that stand first.
      const std::size_t at = 64 + random() % (round % 2 == 0 ? bytes.size() - 72 : 300);
      const std::uint64_t odd[] = {~0ull, 1ull << 63, 1ull << 32, (1ull << 31) - 1, 1000000, rows.size(),
                                   2,     1,          0};
      const std::uint64_t value = odd[random() % std::size(odd)];
      switch (random() % 4) {
        case 0:
          std::memcpy(&bytes[at], &value, 8);
          break;
        case 1:
          std::memcpy(&bytes[at], &value, 4);
          break;
        case 2:
          bytes[at] ^= static_cast<std::byte>(1 << random() % 8);
          break;
        default:
          bytes.resize(at);
      }
      seal(bytes);
      try {
        const FlannIndex index(rows, kWords, bytes, options);
        index.search(queries, 100);
        ++taken;
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
        ++refused;
      }
    }
    EXPECT_GT(refused, 200) << name_of(kind);
    EXPECT_GT(taken, 20) << name_of(kind);
  }
}

TEST(FlannIndex, SaysWhatToDoWhenItWouldTakeTooMuchMemory) {
  const auto rows = random_words({.rows = 1000, .words = kWords});
  const std::string fault =
      fault_of(ErrorKind::kUsage, [&] { FlannIndex(rows, kWords, {.max_bytes = 1 << 20}); });
  EXPECT_NE(fault.find("exact index"), std::string::npos);
}

TEST(FlannIndex, AcceptsNoRows) {
  const vision::OwnWordMaps none;
  const FlannIndex index(none, kWords);
  EXPECT_TRUE(index.search(std::vector{PieceQuery{}}, 5)[0].empty());
  EXPECT_EQ(FlannIndex(none, kWords, index.serialize()).rows(), 0u);
}

}  // namespace
}  // namespace freshet::query
