#include "query/index/index_builder.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>

#include "freshet/error.h"
#include "query/index/dense_histogram.h"
#include "query/index/search_base.h"
#include "stored/average_image.h"
#include "stored/clip_schema.h"
#include "stored/patch_table.h"
#include "stored/stored_codebook.h"
#include "tests/harness/fault.h"
#include "tests/stored/made_store.h"
#include "vision/dense_sift.h"

namespace freshet::query {
namespace {

class WordsOfAStore : public testing::TestWithParam<int> {};

TEST_P(WordsOfAStore, AreThoseOfThePatchesOwnPixels) {
  const ScratchFolder folder;
  vision::Settings settings = made_settings();
  settings.codebook.words = GetParam();
  store::Store store = made_store(folder.path() / "a.store", some_clips(), settings);
  const IndexReport report = build_index(store);
  EXPECT_TRUE(report.words_built);
  EXPECT_EQ(report.words, GetParam());
  const store::Snapshot snapshot = store.snapshot();
  const stored::PatchTable table = stored::read_patch_table(snapshot);
  const vision::Codebook codebook = stored::read_codebook(snapshot);
  EXPECT_EQ(report.patches, table.size());
  EXPECT_EQ(snapshot.column_element(table.clips[0], "patch.words"), GetParam() <= 256 ? 81 : 162);
  const auto variants = settings.variants();
  // The slow twin: each patch described by itself, flipped ones in the flipped frame.
  std::size_t same = 0, points = 0, flipped_same = 0, flipped_points = 0;
  for (stored::Row row = 0; row < table.size(); row += 5) {
    const vision::Variant& variant = variants[table.variant[row]];
    const cv::Mat frame =
        vision::warp_to_variant(stored::average_image(snapshot, table.clips[table.clip[row]]), variant);
    const auto grid =
        vision::dense_sift(frame, {table.x[row], table.y[row]}, vision::kGridSide, vision::kGridSide);
    vision::WordMap words;
    vision::assign_words(codebook, grid.values, words);
    const vision::WordMap kept = table.words[row];
    for (std::size_t point = 0; point < words.size(); ++point) {
      (variant.flip ? flipped_same : same) += words[point] == kept[point];
      ++(variant.flip ? flipped_points : points);
    }
  }
  ASSERT_GT(points, 1000u);
  ASSERT_GT(flipped_points, 1000u);
  EXPECT_EQ(same, points);
  // Mirrored descriptors may differ by a unit, which can tip a word that stands between two.
  EXPECT_GT(static_cast<double>(flipped_same), 0.98 * static_cast<double>(flipped_points));
}

INSTANTIATE_TEST_SUITE_P(OfOneByteAndOfTwo, WordsOfAStore, testing::Values(40, 256, 257, 500));

// Searched exactly and by FLANN's trees from the store.
TEST(IndexBuilder, BuildsWhatFindsPatchesByTheirWordsOfTwoBytes) {
  const ScratchFolder folder;
  vision::Settings settings = made_settings();
  settings.codebook.words = 500;
  store::Store store = made_store(folder.path() / "a.store", some_clips(), settings);
  build_index(store);
  const SearchBase exact = open_search(store.snapshot());
  const SearchBase trees = open_search(
      store.snapshot(), {.flann = FlannKind::kHierarchical, .flann_options = {.checks = 1 << 20}});
  std::vector<PieceQuery> queries;
  for (stored::Row row = 0; row < exact.table.size(); row += 50)
    queries.push_back(whole_query(exact.table.words[row]));
  const auto found = exact.index->search(queries, 20), by_trees = trees.index->search(queries, 20);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    std::vector<ScoredPatch> all;
    for (stored::Row row = 0; row < exact.table.size(); ++row)
      all.push_back({row, static_cast<std::uint32_t>(
                              vision::intersection(queries[i].words, exact.table.words[row], 500))});
    std::sort(all.begin(), all.end(), better);
    all.resize(20);
    EXPECT_EQ(found[i], all);
    EXPECT_EQ(by_trees[i].front(), all.front());
  }
}

TEST(IndexBuilder, GivesTheSameDigestForAnyOrderAndAnyNumberOfThreads) {
  const ScratchFolder folder;
  std::vector<MadeClip> clips = some_clips();
  std::vector<std::string> digests;
  for (const int threads : {1, 2, 8}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    store::Store store = made_store(folder.path() / fmt::format("{}.store", threads), clips);
    // Half of them keep nothing from the first pass.
    build_index(store, {.cache_bytes = threads == 1 ? std::size_t{0} : std::size_t{1} << 30});
    digests.push_back(store.snapshot().digest());
    std::rotate(clips.begin(), clips.begin() + 1, clips.end());
  }
  EXPECT_EQ(digests[0], digests[1]);
  EXPECT_EQ(digests[0], digests[2]);
}

TEST(IndexBuilder, DependsOnTheClipsAndNotOnTheirHistory) {
  const ScratchFolder folder;
  const auto clips = some_clips();
  store::Store at_once = made_store(folder.path() / "once.store", clips);
  build_index(at_once);
  store::Store in_steps = made_store(folder.path() / "steps.store", {clips[0], clips[1]});
  build_index(in_steps, {.flann = {FlannKind::kKdTree}});
  ASSERT_TRUE(in_steps.snapshot().blob("flann-kdtree"));
  for (std::size_t i = 2; i < clips.size(); ++i) add_made_clip(in_steps, made_settings(), clips[i]);
  fault_of(ErrorKind::kNotFound, [&] { stored::read_codebook(in_steps.snapshot()); });
  EXPECT_TRUE(build_index(in_steps).words_built);
  EXPECT_FALSE(in_steps.snapshot().blob("flann-kdtree")) << "an index of words that are gone";
  EXPECT_EQ(in_steps.snapshot().digest(), at_once.snapshot().digest());
}

TEST(IndexBuilder, DoesNothingWhenNoClipIsNew) {
  const ScratchFolder folder;
  store::Store store = made_store(folder.path() / "a.store", some_clips());
  const IndexReport first = build_index(store);
  ASSERT_EQ(first.flann_built.size(), 1U);
  EXPECT_EQ(first.flann_built[0].kind, FlannKind::kHierarchical);
  EXPECT_GT(first.flann_built[0].tuning.checks, 0U);
  EXPECT_GE(first.flann_built[0].tuning.recall, 0.9F);
  const std::string digest = store.snapshot().digest();
  const auto trees = store.snapshot().blob("flann-hierarchical");
  ASSERT_TRUE(trees);
  const IndexReport again = build_index(store);
  EXPECT_FALSE(again.words_built);
  EXPECT_TRUE(again.flann_built.empty());
  EXPECT_EQ(store.snapshot().blob("flann-hierarchical"), trees);
  EXPECT_TRUE(build_index(store, {.rebuild = true}).words_built);
  EXPECT_EQ(store.snapshot().digest(), digest);
}

TEST(IndexBuilder, HoldsTheFlannIndexesThatAreWantedAndNoStoreDiffersByThem) {
  const ScratchFolder folder;
  store::Store store = made_store(folder.path() / "a.store", some_clips());
  const auto holds = [&](const char* name) { return store.snapshot().blob(name).has_value(); };
  EXPECT_TRUE(build_index(store, {.flann = {}}).flann_built.empty());
  EXPECT_FALSE(holds("flann-hierarchical"));
  const std::string digest = store.snapshot().digest();
  EXPECT_EQ(build_index(store, {.flann = {FlannKind::kKMeans}}).flann_built.size(), 1U);
  EXPECT_EQ(build_index(store).flann_built.size(), 1U);
  EXPECT_TRUE(holds("flann-hierarchical") && holds("flann-kmeans"));
  EXPECT_EQ(store.snapshot().digest(), digest);

  EXPECT_FALSE(build_index(store, {.flann = {}}).words_built);
  EXPECT_FALSE(holds("flann-hierarchical") || holds("flann-kmeans"));
  const IndexReport large = build_index(store, {.flann_max_bytes = 1000});
  EXPECT_TRUE(large.flann_too_large && large.flann_built.empty());
  EXPECT_FALSE(holds("flann-hierarchical"));
}

TEST(IndexBuilder, LeavesTheStoreAsItWasWhenStopped) {
  const ScratchFolder folder;
  store::Store store = made_store(folder.path() / "a.store", some_clips());
  const std::string digest = store.snapshot().digest();
  std::stop_source source;
  fault_of(ErrorKind::kCancelled, [&] {
    build_index(
        store, {},
        [&](const Progress& at) {
          if (at.stage == "assigning words") source.request_stop();
        },
        source.get_token());
  });
  EXPECT_EQ(store.snapshot().digest(), digest);
}

TEST(IndexBuilder, SaysThatThereIsNothingToIndex) {
  const ScratchFolder folder;
  store::Store store = made_store(folder.path() / "a.store", {{.name = "empty.mp4", .patches = false}});
  for (auto&& work : {+[](store::Store& s) { build_index(s); },
                      +[](store::Store& s) { stored::read_patch_table(s.snapshot()); },
                      +[](store::Store& s) { stored::read_codebook(s.snapshot()); }}) {
    fault_of(ErrorKind::kNotFound, [&] { work(store); });
  }
}

TEST(TryCodebook, GivesWhatAStoreOfSuchWordsHoldsAndWritesNothing) {
  const ScratchFolder folder;
  vision::Settings settings = made_settings();
  store::Store store = made_store(folder.path() / "a.store", some_clips(), settings);
  build_index(store);
  const std::string digest = store.snapshot().digest();
  settings.codebook.words = 300;
  store::Store other = made_store(folder.path() / "b.store", some_clips(), settings);
  build_index(other);
  const TriedCodebook tried = try_codebook(store, settings.codebook);
  EXPECT_EQ(tried.codebook.centres, stored::read_codebook(other.snapshot()).centres);
  EXPECT_EQ(tried.words, stored::read_patch_table(other.snapshot()).words);
  EXPECT_EQ(store.snapshot().digest(), digest);
}

TEST(PatchTable, AsksForAnIndexWhenThereIsNone) {
  const ScratchFolder folder;
  store::Store store = made_store(folder.path() / "a.store", some_clips());
  const std::string fault =
      fault_of(ErrorKind::kNotFound, [&] { stored::read_patch_table(store.snapshot()); });
  EXPECT_NE(fault.find("freshet index"), std::string::npos);
}

TEST(PatchTable, RefusesWordsOfAnotherWidthByName) {
  const ScratchFolder folder;
  for (const int words : {40, 500}) {
    vision::Settings settings = made_settings();
    settings.codebook.words = words;
    store::Store store = made_store(folder.path() / fmt::format("{}.store", words), some_clips(), settings);
    build_index(store);
    const std::string digest = store.snapshot().digest();
    const store::ClipId clip = store.snapshot().clips()[1];
    const vision::OwnWordMaps other(3 - vision::word_bytes(words), store.snapshot().clip(clip).rows);
    const store::Store::Column column = stored::kPatchWords.column(clip, other);
    store.write({}, std::span(&column, 1));
    const std::string fault =
        fault_of(ErrorKind::kDamaged, [&] { stored::read_patch_table(store.snapshot()); });
    for (const std::string& part : {store.snapshot().clip(clip).name, std::string("patch.words"),
                                    std::string("162"), std::string("index --rebuild")})
      EXPECT_NE(fault.find(part), std::string::npos) << fault;
    build_index(store, {.rebuild = true});
    EXPECT_EQ(store.snapshot().digest(), digest);
  }
}

TEST(PatchTable, RefusesPatchesBeyondTheirFrame) {
  const ScratchFolder folder;
  store::Store store = made_store(folder.path() / "a.store", some_clips());
  build_index(store);
  const store::ClipId clip = store.snapshot().clips()[1];
  for (const auto& [name, value] :
       {std::pair<const char*, std::uint16_t>{"patch.x", 150}, {"patch.y", 60000}}) {
    auto column = store.snapshot().column<std::uint16_t>(clip, name);
    const auto whole = column;
    column[7] = value;
    const auto write = [&](const std::vector<std::uint16_t>& values) {
      const store::Store::Column replaced{clip, name, std::as_bytes(std::span(values)), 2};
      store.write({}, std::span(&replaced, 1));
    };
    write(column);
    fault_of(ErrorKind::kDamaged, [&] { stored::read_patch_table(store.snapshot()); });
    write(whole);
  }
  EXPECT_GT(stored::read_patch_table(store.snapshot()).size(), 0u);
}

TEST(StoredCodebook, RefusesBytesThatCannotBeOne) {
  const ScratchFolder folder;
  store::Store store = made_store(folder.path() / "a.store", some_clips());
  build_index(store);
  const std::vector<std::byte> whole = *store.snapshot().blob(stored::kCodebookBlob);
  const auto refused = [&](std::vector<std::byte> bytes) {
    const store::Store::Blob blob{stored::kCodebookBlob, bytes, true};
    store.write(std::span(&blob, 1));
    return kind_of([&] { stored::find_codebook(store.snapshot()); }) == ErrorKind::kDamaged;
  };
  EXPECT_TRUE(refused({}));
  EXPECT_TRUE(refused({whole.begin(), whole.begin() + 20}));
  EXPECT_TRUE(refused({whole.begin(), whole.end() - 1}));
  auto many = whole;
  many[11] = std::byte{0x7f};  // words: 2^31 or so
  EXPECT_TRUE(refused(many));
  auto no_number = whole;
  ASSERT_GT(no_number.size(), 28u);
  std::fill_n(no_number.end() - 4, 4, std::byte{0xff});
  EXPECT_TRUE(refused(no_number));
  EXPECT_FALSE(refused(whole));
}

}  // namespace
}  // namespace freshet::query
