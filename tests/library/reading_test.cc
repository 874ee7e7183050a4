// What a program outside reads of a store: footage, patches by likeness, drawn videos, and an index of its own.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "freshet/benchmark.h"
#include "freshet/error.h"
#include "freshet/footage.h"
#include "freshet/sample.h"
#include "freshet/search.h"
#include "query/index/index_builder.h"
#include "tests/stored/made_store.h"

namespace freshet {
namespace {

struct Opened {
  ScratchFolder folder;
  Store store;

  explicit Opened(int words = made_settings().codebook.words)
      : store(made(folder.path() / "made.store", words)) {}
  static std::filesystem::path made(const std::filesystem::path& path, int words) {
    vision::Settings settings = made_settings();
    settings.codebook.words = words;
    store::Store store =
        made_store(path, {{.name = "a"}, {.name = "b", .texture = 2, .frame_s = 0.05}}, settings);
    query::build_index(store, {});
    return path;
  }
};

ErrorKind kind_of(const auto& work) {
  try {
    work();
  } catch (const Error& fault) {
    return fault.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::kIo;
}

TEST(Footage, GivesWhatTheStoreKeeps) {
  const Opened opened;
  const Footage footage(opened.store, "b");
  const auto patches = static_cast<int>(footage.clip().patches);
  EXPECT_EQ(footage.pixel_format(), "gray");
  EXPECT_EQ(cv::norm(footage.planes(3, 2)[0], footage.luma(3, 2), cv::NORM_INF), 0);
  EXPECT_EQ(footage.bgr(0, 4).size[0], 4);
  EXPECT_EQ(footage.column("patch.words").size(), cv::Size(81, patches));
  EXPECT_EQ(footage.column("patch.motion").type(), CV_32F);
  EXPECT_NEAR(footage.column("frame.time").at<double>(2, 0), 0.1, 1e-9);
  EXPECT_EQ(footage.cells("motion").dims, 3);
  EXPECT_EQ(kind_of([&] { footage.column("none"); }), ErrorKind::kNotFound);
  EXPECT_EQ(kind_of([&] { footage.cells("none"); }), ErrorKind::kNotFound);
  EXPECT_EQ(kind_of([&] { footage.bgr(99, 2); }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([&] { footage.bgr(1, 0xffffffff); }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([&] { Footage(opened.store, "c"); }), ErrorKind::kNotFound);
  for (const std::string& name : footage.columns()) EXPECT_FALSE(footage.column(name).empty()) << name;
  EXPECT_EQ(variants(opened.store).size(), made_settings().variants().size());
}

class Nearest : public testing::TestWithParam<int> {};

TEST_P(Nearest, TheExactIndexAndTheScanAgree) {
  const Opened opened(GetParam());
  const cv::Mat words = Footage(opened.store, "b").column("patch.words").rowRange(10, 20);
  EXPECT_EQ(words.type(), GetParam() <= 256 ? CV_8U : CV_16U);
  EXPECT_EQ(kind_of([&] { nearest_by_words(opened.store, words.colRange(0, 80), 9); }), ErrorKind::kUsage);
  const PatchTable by_words = nearest_by_words(opened.store, words, 30);
  const PatchTable by_histograms =
      nearest_by_histograms(opened.store, histograms_of(opened.store, words), 30);
  EXPECT_EQ(cv::norm(by_words.patches, by_histograms.patches, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(by_words.scores, by_histograms.scores, cv::NORM_INF), 0);
  EXPECT_EQ(by_words.scores.at<float>(3, 0), 1);
  EXPECT_EQ(kind_of([&] { nearest_by_words(opened.store, words, 0); }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([&] { nearest_by_histograms(opened.store, words, 9); }), ErrorKind::kUsage);
  // More than there are.
  const auto all = static_cast<int>(opened.store.first_patches().back());
  const PatchTable wide = nearest_by_words(opened.store, words, all + 1);
  EXPECT_EQ(wide.patches.at<int>(0, all), -1);
  EXPECT_NE(wide.patches.at<int>(0, all - 1), -1);
}

INSTANTIATE_TEST_SUITE_P(WordsOfOneByteAndOfTwo, Nearest, testing::Values(40, 300));

TEST(Sampler, DrawsEveryPatchOnceWhateverTheShards) {
  const Opened opened;
  const Sampler whole(opened.store, {.seed = 3, .frames = 20});
  EXPECT_EQ(whole.size(), opened.store.first_patches().back());
  std::set<std::pair<std::string, std::uint64_t>> drawn;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const SampledPatch at = whole.at(i);
    EXPECT_LE(at.first, 80u);
    drawn.insert({at.clip, at.patch});
    const SampledPatch shared =
        Sampler(opened.store, {.seed = 3, .frames = 20, .shard = i % 3, .shards = 3}).at(i / 3);
    ASSERT_TRUE(shared.clip == at.clip && shared.patch == at.patch && shared.first == at.first);
    if (i == 60) break;
  }
  EXPECT_EQ(drawn.size(), 61u);
  const cv::Mat videos = whole.read(2, 3);
  const cv::Mat one = whole.read(4, 1);
  EXPECT_EQ(std::memcmp(videos.ptr(2), one.ptr(0), 20u * 48 * 48 * 3), 0);
  EXPECT_EQ(kind_of([&] { whole.read(whole.size(), 1); }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([&] { Sampler(opened.store, {.frames = 101}); }), ErrorKind::kNotFound);
  EXPECT_EQ(kind_of([&] { Sampler(opened.store, {.shard = 2, .shards = 2}); }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([&] { Sampler(opened.store, {.class_name = "fire"}); }), ErrorKind::kNotFound);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(kind_of([&] { whole.read(0, 2, {.stop = stop.get_token()}); }), ErrorKind::kCancelled);
}

// Brute force over the vectors that it is given.
OwnIndex brute_force(cv::Mat& kept) {
  return {.name = "own",
          .build = [&kept](const cv::Mat& patches) { kept = patches; },
          .search =
              [&kept](const cv::Mat& questions, int k) {
                cv::Mat found(questions.rows, k, CV_32S);
                for (int i = 0; i < questions.rows; ++i) {
                  std::vector<std::pair<double, int>> far;
                  for (int row = 0; row < kept.rows; ++row)
                    far.push_back({cv::norm(questions.row(i), kept.row(row), cv::NORM_L1), row});
                  std::sort(far.begin(), far.end());
                  for (int j = 0; j < k; ++j) found.at<int>(i, j) = far[static_cast<std::size_t>(j)].second;
                }
                return found;
              }};
}

TEST(Benchmark, AnExactIndexOfOnesOwnFindsAll) {
  const Opened opened;
  cv::Mat kept;
  const nlohmann::json report = nlohmann::json::parse(benchmark(
      opened.store, brute_force(kept), {}, {.pieces = 10, .setting_limit_s = 0.01, .label = false}));
  const nlohmann::json& own = report["indexes"][2];
  EXPECT_EQ(own["name"], "own");
  EXPECT_EQ(own["settings"][0]["recall_100"], 1);
  for (const nlohmann::json& filter : own["filters"]) EXPECT_EQ(filter["recall_100"], 1) << filter;
  OwnIndex wrong = brute_force(kept);
  wrong.search = [](const cv::Mat& questions, int k) {
    return cv::Mat(questions.rows, k, CV_32S, cv::Scalar(1 << 20));
  };
  const nlohmann::json skipped = nlohmann::json::parse(
      benchmark(opened.store, wrong, {}, {.pieces = 10, .label = false, .filters = false}));
  EXPECT_NE(skipped["indexes"][2]["skipped"].get<std::string>().find("names row"), std::string::npos);
  OwnIndex throwing = brute_force(kept);
  throwing.build = [](const cv::Mat&) { throw std::logic_error("mine"); };
  EXPECT_THROW(benchmark(opened.store, throwing, {}, {.pieces = 10, .label = false, .filters = false}),
               std::logic_error);
}

TEST(Benchmark, RecallCountsWhatLiesAsNear) {
  const Opened opened;
  const SearchProblem problem = search_problem(opened.store, 8, {}, {.pieces = 5});
  cv::Mat kept;
  const OwnIndex own = brute_force(kept);
  own.build(problem.patches);
  EXPECT_EQ(recall(problem, own.search(problem.questions, 8), 8), 1);
  cv::Mat half = problem.neighbours.clone();
  half.colRange(4, 8).setTo(-1);
  EXPECT_NEAR(recall(problem, half, 8), 0.5, 1e-12);
  for (int i = 0; i < half.rows; ++i) half.row(i).colRange(4, 8).setTo(half.at<int>(i, 0));
  EXPECT_NEAR(recall(problem, half, 8), 0.5, 1e-12);  // the same one again counts once
  EXPECT_EQ(kind_of([&] { recall(problem, half, 9); }), ErrorKind::kUsage);
}

}  // namespace
}  // namespace freshet
