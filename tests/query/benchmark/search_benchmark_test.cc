#include "query/benchmark/search_benchmark.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "freshet/error.h"
#include "query/benchmark/measured_indexes.h"
#include "query/benchmark/search_page.h"
#include "query/benchmark/subset_index.h"
#include "query/index/exact_index.h"
#include "query/index/index_builder.h"
#include "stored/store_settings.h"
#include "stored/stored_codebook.h"
#include "tests/harness/fault.h"
#include "tests/query/index/random_words.h"
#include "tests/stored/made_store.h"

namespace freshet::query {
namespace {

// A store of four clips with its index, open.
struct Opened {
  ScratchFolder folder;
  store::Store store = made_store(folder.path() / "made.store", some_clips());
  IndexReport index = build_index(store, {.flann = {FlannKind::kHierarchical}});
  store::Snapshot snapshot = store.snapshot();
  SearchBase base;

  Opened() {
    base.settings = stored::settings_of(snapshot);
    base.codebook = stored::read_codebook(snapshot);
    base.table = stored::read_patch_table(snapshot);
  }
};

const SearchBenchmarkOptions kQuick{.pieces = 24, .setting_limit_s = 0.02, .checked = 24};

BenchmarkPicture a_picture() {
  BenchmarkPicture picture{"pond", {}, cv::Mat(144, 192, CV_8U, cv::Scalar(255))};
  cv::cvtColor(made_texture(9), picture.picture, cv::COLOR_GRAY2BGR);
  return picture;
}

const IndexResult& result_of(const SearchReport& report, const std::string& name) {
  const auto found = std::find_if(report.indexes.begin(), report.indexes.end(),
                                  [&](const IndexResult& index) { return index.name == name; });
  if (found == report.indexes.end()) throw std::runtime_error(name + " is missing");
  return *found;
}

TEST(SearchBenchmark, MeasuresEveryIndexThatIsInstalled) {
  Opened opened;
  const auto indexes = measured_indexes();
  const SearchReport report = benchmark_search(opened.snapshot, opened.base, {a_picture()}, indexes, kQuick);
  EXPECT_EQ(report.rows, opened.base.table.size());
  EXPECT_EQ(report.checked, 24U);
  EXPECT_EQ(report.wrong, 0U);
  ASSERT_EQ(report.indexes.size(), indexes.size());
  for (const IndexResult& index : report.indexes) {
    if (!index.package.empty()) continue;  // not installed
    EXPECT_EQ(index.skipped, "") << index.name;
    ASSERT_FALSE(index.settings.empty()) << index.name;
    EXPECT_GT(index.bytes, 0U) << index.name;
    for (const SettingResult& setting : index.settings) {
      EXPECT_GE(setting.pieces, 10U) << index.name;
      EXPECT_GT(setting.times.median_ms, 0) << index.name;
      EXPECT_LE(setting.times.median_ms, setting.times.p99_ms) << index.name;
      ASSERT_TRUE(setting.energy_loss) << index.name;
    }
    const SettingResult& best = index.settings.back();
    EXPECT_GT(best.recall.at_100, index.is_exact ? 0.9999 : 0.5) << index.name;
    EXPECT_GE(best.recall.at_100, index.settings.front().recall.at_100 - 0.05) << index.name;
    EXPECT_NEAR(*best.energy_loss, 0, index.is_exact ? 1e-9 : 0.05) << index.name;
    EXPECT_GE(index.filters.size(), 2U) << index.name;
    for (const FilterResult& filter : index.filters) {
      EXPECT_GT(filter.admitted, 0) << index.name;
      EXPECT_LT(filter.admitted, 1) << index.name;
      if (index.is_exact) {
        EXPECT_EQ(filter.recall, 1) << index.name << ", " << filter.condition;
        EXPECT_EQ(filter.short_of, 0U) << index.name;
      }
    }
  }
  EXPECT_TRUE(result_of(report, "flann-hierarchical").from_store);
  EXPECT_GT(result_of(report, "flann-hierarchical").build_seconds, 0);
  EXPECT_NE(result_of(report, "flann-hierarchical").settings.back().name.find("tuned"), std::string::npos);
  EXPECT_FALSE(result_of(report, "flann-kdtree").from_store);
}

TEST(SearchBenchmark, SaysTheSameOnItsPageAndInJson) {
  Opened opened;
  const auto indexes = measured_indexes();
  const SearchReport report = benchmark_search(opened.snapshot, opened.base, {a_picture()}, indexes,
                                               {.pieces = 12, .setting_limit_s = 0.01, .label = false});
  const std::string page = search_page(report);
  const nlohmann::json json = to_json(report);
  ASSERT_EQ(json["indexes"].size(), indexes.size());
  for (std::size_t i = 0; i < indexes.size(); ++i) {
    EXPECT_NE(page.find("<dt>" + indexes[i].name + "</dt>"), std::string::npos);
    EXPECT_EQ(json["indexes"][i]["name"], indexes[i].name);
    if (!indexes[i].build) {
      EXPECT_NE(page.find(indexes[i].package), std::string::npos);
    }
    for (const SettingResult& setting : report.indexes[i].settings)
      EXPECT_NE(page.find("<td>" + setting.name + "</td>"), std::string::npos);
  }
  for (const char* expected : {"<svg", "pond", "made.store", "With conditions", "prefers-color-scheme: dark",
                               "brute force, 0 wrong", report.machine.processor.c_str()})
    EXPECT_NE(page.find(expected), std::string::npos) << expected;
  // One file, no script, nothing from elsewhere but the name of SVG itself.
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("src="), std::string::npos);
  EXPECT_EQ(page.find("href="), std::string::npos);
  EXPECT_EQ(page.find("Energy: of"), std::string::npos) << "nothing was labelled";
}

TEST(SearchBenchmark, WithoutPicturesAsksForOneClipAmongTheOthers) {
  Opened opened;
  const auto exact = std::vector{measured_indexes()[0]};
  const SearchReport report = benchmark_search(opened.snapshot, opened.base, {}, exact, kQuick);
  EXPECT_FALSE(report.held_out.empty());
  EXPECT_EQ(report.pictures, std::vector{report.held_out});
  EXPECT_LT(report.rows, report.patches);
  EXPECT_GT(report.rows, report.patches / 2);
  EXPECT_EQ(report.wrong, 0U);
  EXPECT_EQ(report.indexes[0].settings[0].recall.at_100, 1);
  const BenchmarkPieces pieces = benchmark_pieces(opened.snapshot, opened.base, {}, 10, 100);
  EXPECT_EQ(pieces.rows.size(), 100U);
  for (const stored::Row row : pieces.rows)
    EXPECT_NE(opened.snapshot.clip(opened.base.table.clips[opened.base.table.clip[row]]).name,
              pieces.held_out);
}

TEST(SearchBenchmark, RefusesMoreRowsThanThereAre) {
  Opened opened;
  const auto exact = std::vector{measured_indexes()[0]};
  EXPECT_THROW(benchmark_search(opened.snapshot, opened.base, {}, exact, {.rows = 1'000'000}), Error);
  std::stop_source stop;
  stop.request_stop();
  fault_of(ErrorKind::kCancelled,
           [&] { benchmark_search(opened.snapshot, opened.base, {}, exact, kQuick, {}, stop.get_token()); });
}

// An index that is exact, but takes its time to build, or fails.
MeasuredIndex slow(double seconds_per_row) {
  return {.name = "slow", .what = "", .build = [=](const SearchSpace& space) -> BuiltIndex {
            const double until =
                report::thread_seconds() + seconds_per_row * static_cast<double>(space.words.size());
            while (report::thread_seconds() < until) continue;
            return {std::make_shared<ExactIndex>(space.words, space.word_count), {{"", [] {}}}};
          }};
}

TEST(SearchBenchmark, AnIndexThatWouldPassTheLimitIsBuiltOfFewerRowsAndJudgedByThose) {
  Opened opened;
  const double all = static_cast<double>(opened.base.table.size());
  const SearchBenchmarkOptions options{
      .pieces = 12, .build_limit_s = 0.2, .min_rows = 20, .setting_limit_s = 0.01, .label = false};
  const auto measure = [&](double seconds) {
    const auto indexes = std::vector{slow(seconds / all)};
    return benchmark_search(opened.snapshot, opened.base, {a_picture()}, indexes, options).indexes[0];
  };
  const IndexResult fast = measure(0.05), never = measure(40);
  IndexResult medium = measure(0.8);
  for (int more = 0; more < 4 && medium.projected_build_seconds > 1.2; ++more)
    medium = measure(0.8);  // a busy machine disturbs one of several
  EXPECT_EQ(fast.rows, opened.base.table.size());
  EXPECT_EQ(fast.projected_build_seconds, 0);
  EXPECT_LT(medium.rows, all / 2);
  EXPECT_GT(medium.rows, all / 16);
  EXPECT_LT(medium.build_seconds, 0.4);
  EXPECT_NEAR(medium.projected_build_seconds, 0.8, 0.4);
  EXPECT_EQ(medium.settings[0].recall.at_100, 1);
  EXPECT_NE(never.skipped.find("would pass the limits"), std::string::npos);
  EXPECT_TRUE(never.settings.empty());
}

TEST(SearchBenchmark, WhatAnIndexThrowsIsWhyItHasNoResult) {
  Opened opened;
  const auto indexes = std::vector{MeasuredIndex{.name = "broken",
                                                 .what = "",
                                                 .build = [](const SearchSpace&) -> BuiltIndex {
                                                   throw Error(ErrorKind::kIo, "broken", "it broke");
                                                 }},
                                   measured_indexes()[0]};
  const SearchReport report = benchmark_search(opened.snapshot, opened.base, {a_picture()}, indexes, kQuick);
  EXPECT_NE(report.indexes[0].skipped.find("it broke"), std::string::npos);
  EXPECT_FALSE(report.indexes[1].settings.empty());
  EXPECT_NE(search_page(report).find("it broke"), std::string::npos);
}

// Exact, but stopped in the middle of a labelling, which is the only one to ask for more pieces than are measured.
class StoppedInLabelling final : public CandidateIndex {
 public:
  explicit StoppedInLabelling(const SearchSpace& space) : exact_(space.words, space.word_count) {}
  std::size_t rows() const override { return exact_.rows(); }
  std::vector<std::vector<ScoredPatch>> search(std::span<const PieceQuery> queries, std::size_t k,
                                               const SearchFilter& search_filter) const override {
    if (queries.size() > kFew.pieces) throw Error(ErrorKind::kCancelled, "labelling", "stopped");
    return exact_.search(queries, k, search_filter);
  }
  static constexpr SearchBenchmarkOptions kFew{.pieces = 2, .setting_limit_s = 0.01, .checked = 2};

 private:
  ExactIndex exact_;
};

TEST(SearchBenchmark, LeavesTheBaseItsIndexWhateverIsThrown) {
  Opened opened;
  opened.base.index = std::make_unique<ExactIndex>(opened.base.table.words, opened.base.codebook.words);
  const CandidateIndex* const own = opened.base.index.get();
  const auto exact = std::vector{measured_indexes()[0], slow(0)};
  const SearchReport report = benchmark_search(opened.snapshot, opened.base, {a_picture()}, exact, kQuick);
  ASSERT_TRUE(report.indexes[1].settings[0].energy_loss.has_value());
  EXPECT_EQ(opened.base.index.get(), own);
  const auto stopped = std::vector{
      MeasuredIndex{.name = "stopped", .what = "", .build = [](const SearchSpace& space) -> BuiltIndex {
                      return {std::make_shared<StoppedInLabelling>(space), {{"", [] {}}}};
                    }}};
  EXPECT_THROW(
      benchmark_search(opened.snapshot, opened.base, {a_picture()}, stopped, StoppedInLabelling::kFew),
      Error);
  EXPECT_EQ(opened.base.index.get(), own);
}

TEST(Recall, CountsWhatScoresAsWellAndNothingTwice) {
  const auto words = random_words({.rows = 300, .words = 50, .clusters = 3});
  const SearchSpace space{words, 50};
  const std::vector queries{whole(words[0])};
  const std::vector<std::vector<ScoredPatch>> exact{brute_force(words, 50, queries[0], 100)};
  EXPECT_EQ(recall_of(exact, exact, queries, space).at_100, 1);
  auto answer = exact;
  // Claimed scores are not believed, a row given twice counts once, rows that there are not count nothing.
  for (ScoredPatch& scored : answer[0]) scored.score = 324;
  EXPECT_EQ(recall_of(answer, exact, queries, space).at_100, 1);
  for (std::size_t i = 50; i < 100; ++i) answer[0][i] = answer[0][0];
  EXPECT_DOUBLE_EQ(recall_of(answer, exact, queries, space).at_100, 0.5);
  answer[0][49].row = 100'000;
  const Recall recall = recall_of(answer, exact, queries, space);
  EXPECT_DOUBLE_EQ(recall.at_100, 0.49);
  EXPECT_DOUBLE_EQ(recall.worst, 0.49);
  EXPECT_EQ(recall.at_10, 1);
  std::reverse(answer[0].begin(), answer[0].begin() + 49);
  EXPECT_LT(recall_of(answer, exact, queries, space).at_1, 1);
  EXPECT_EQ(recall_of(std::vector<std::vector<ScoredPatch>>(1), exact, queries, space).at_1, 0);
}

TEST(Recall, ATieAtTheEndIsAsGood) {
  const vision::OwnWordMaps words(1, 200);  // all alike
  const SearchSpace space{words, 50};
  const std::vector queries{whole(words[0])};
  const std::vector<std::vector<ScoredPatch>> exact{brute_force(words, 50, queries[0], 100)};
  std::vector<std::vector<ScoredPatch>> other(1);
  for (stored::Row row = 100; row < 200; ++row) other[0].push_back({row, 324});
  EXPECT_EQ(recall_of(other, exact, queries, space).at_100, 1);
  EXPECT_EQ(recall_of(other, exact, queries, space).at_1, 1);
}

TEST(SubsetIndex, AnswersAsAnIndexOfThoseRowsInTheTablesNumbers) {
  const auto words = random_words({.rows = 500, .words = 50, .clusters = 5});
  std::vector<stored::Row> rows;
  for (stored::Row row = 3; row < words.size(); row += 3) rows.push_back(row);
  const vision::OwnWordMaps some = vision::rows_of(words, rows);
  const ExactIndex inner(some, 50);
  const SubsetIndex subset(inner, rows, words.size());
  RowFilter only(words.size(), false), allowed(words.size());
  for (const stored::Row row : rows) only.allow(row);
  for (std::size_t row = 0; row < words.size(); row += 2) {
    allowed.forbid(row);
    only.forbid(row);
  }
  const std::vector queries{whole(words[10]), whole(words[33])};
  const auto answers = subset.search(queries, 20, {.rows = &allowed});
  for (std::size_t i = 0; i < queries.size(); ++i)
    EXPECT_EQ(answers[i], brute_force(words, 50, queries[i], 20, &only));
}

TEST(SearchWidening, GivesAllAdmittedRowsThatThereAre) {
  RowFilter filter(1000, false);
  for (const std::size_t row : {5u, 500u, 999u}) filter.allow(row);
  std::vector<std::size_t> asked;
  const auto ask = [&](std::size_t count) {
    asked.push_back(count);
    std::vector<ScoredPatch> scored_patches;
    for (stored::Row row = 0; row < count; ++row) scored_patches.push_back({row, 1000 - row});
    return scored_patches;
  };
  EXPECT_EQ(search_widening(1000, 2, {.rows = &filter}, 0, ask),
            (std::vector<ScoredPatch>{{5, 995}, {500, 500}}));
  EXPECT_EQ(asked, (std::vector<std::size_t>{2, 8, 32, 128, 512}));
  EXPECT_EQ(search_widening(1000, 100, {.rows = &filter}, 0, ask).size(), 3U);
  EXPECT_EQ(search_widening(1000, 7, {}, 0, ask).size(), 7U);
  EXPECT_TRUE(search_widening(0, 7, {}, 0, ask).empty());
}

}  // namespace
}  // namespace freshet::query
