#include "bench/scale/scaled_store.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "freshet/error.h"
#include "ingest/ingest.h"
#include "query/index/index_builder.h"
#include "query/index/patch_descriptors.h"
#include "query/index/search_base.h"
#include "stored/average_image.h"
#include "stored/clip_schema.h"
#include "stored/stored_codebook.h"
#include "tests/harness/scratch_folder.h"
#include "tests/ingest/synthetic_clip.h"

namespace freshet::bench {
namespace {

const vision::Settings kSettings = [] {
  vision::Settings settings;
  settings.codebook.words = 40;
  settings.codebook.iterations = 4;
  return settings;
}();

/// Two clips, ingested and indexed; their sides are multiples of 8 px, as windows' are.
class ScaledStore : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ScratchFolder;
    std::filesystem::create_directories(*folder_ / "water");
    ingest::write_clip(
        *folder_ / "water/wide.mkv",
        {.size = {256, 144}, .frames = 40, .moving = {0, 24, 256, 120}, .changing = true, .seed = 1});
    ingest::write_clip(*folder_ / "water/high.mkv", {.size = {192, 144}, .changing = true, .seed = 2});
    store::Store store = store::Store::create(*folder_ / "source.store", vision::to_json(kSettings));
    const std::filesystem::path paths[] = {*folder_ / "water"};
    ingest::ingest(store, kSettings, paths);
    query::build_index(store);
    source_ = new store::Store(store);
  }
  static void TearDownTestSuite() {
    delete source_;
    delete folder_;
  }

  static store::Snapshot source() { return source_->snapshot(); }
  static std::filesystem::path out(const std::string& name) { return *folder_ / name; }
  static store::Store scaled(const std::string& name, const ScaleOptions& options) {
    write_scaled_store(source(), out(name), options);
    return store::Store::open_read(out(name));
  }

  static ScratchFolder* folder_;
  static store::Store* source_;
};
ScratchFolder* ScaledStore::folder_ = nullptr;
store::Store* ScaledStore::source_ = nullptr;

constexpr Jitter kNone{.rotation_deg = 0,
                       .zoom = 0,
                       .mirrored = false,
                       .bend_px = 0,
                       .detail = 0,
                       .gain = 0,
                       .gamma = 0,
                       .noise = 0,
                       .speed = 0};

TEST_F(ScaledStore, WithoutJitterACopyIsItsSource) {
  const store::Snapshot snapshot = source();
  const vision::Codebook codebook = stored::read_codebook(snapshot);
  for (const store::ClipId id : snapshot.clips()) {
    const SourceClip clip = read_source_clip(snapshot, kSettings, id, 3);
    const JitteredClip copy = jittered_clip(clip, kSettings, codebook, kNone, clip.average.size(), 1, 0);
    ASSERT_EQ(copy.columns.average.size(), clip.average.size());
    EXPECT_LE(cv::norm(copy.columns.average, clip.average, cv::NORM_INF), 2) << "of 65535";
    ASSERT_EQ(copy.frames.size(), 3u);
    EXPECT_EQ(cv::norm(copy.frames[2], clip.frames[2], cv::NORM_INF), 0);
    EXPECT_EQ(copy.columns.motion.values, clip.motion.values);
    ASSERT_EQ(copy.columns.texture.size(), clip.texture.size());
    for (std::size_t scale = 0; scale < clip.texture.size(); ++scale)
      EXPECT_EQ(copy.columns.texture[scale].values, clip.texture[scale].values);
    // What moves is measured again: the patches are the ones that ingest found.
    EXPECT_EQ(copy.columns.patches.variant, stored::kPatchVariant.read(snapshot, id));
    EXPECT_EQ(copy.columns.patches.x, stored::kPatchX.read(snapshot, id));
    EXPECT_EQ(copy.columns.patches.y, stored::kPatchY.read(snapshot, id));
    EXPECT_EQ(copy.columns.patches.coverage, stored::kPatchCoverage.read(snapshot, id));
    const auto words = stored::kPatchWords.read(snapshot, id, 1);
    ASSERT_GT(words.size(), 50u);
    ASSERT_EQ(copy.columns.patches.words.size(), words.size());
    std::size_t other = 0;
    for (std::size_t row = 0; row < words.size(); ++row)
      other += copy.columns.patches.words[row] != words[row];
    EXPECT_LE(other, words.size() / 20) << "a step of rounding in the average image may turn a word";
  }
}

TEST_F(ScaledStore, MotionIsTurnedZoomedMirroredAndSpedUp) {
  const store::Snapshot snapshot = source();
  const vision::Codebook codebook = stored::read_codebook(snapshot);
  SourceClip clip = read_source_clip(snapshot, kSettings, snapshot.clips()[0], 3);
  const auto channels = static_cast<std::size_t>(clip.motion.channels);
  for (std::size_t i = 0; i < clip.motion.values.size(); i += channels) {
    // Everywhere the same velocity, and power along it alone: u and v beat together.
    const float u = 30, v = 10;
    std::fill_n(clip.motion.values.begin() + static_cast<std::ptrdiff_t>(i), channels, 0.0f);
    clip.motion.values[i] = u;
    clip.motion.values[i + 1] = v;
    vision::set_band_power(&clip.motion.values[i], 0, {.u = u * u, .v = v * v, .cross = u * v});
  }
  std::set<bool> mirrored;
  for (std::uint64_t number = 0; number < 8; ++number) {
    const JitteredClip copy = jittered_clip(clip, kSettings, codebook, {}, {160, 120}, 1, number);
    const auto made = nlohmann::json::parse(to_json(copy.metadata)).at("generated");
    const vision::Variant variant{made.at("zoom"), made.at("rotation_deg"), made.at("mirrored")};
    mirrored.insert(variant.flip);
    const double speed = made.at("speed");
    const cv::Vec2d expected =
        vision::variant_frame({256, 144}, variant).variant_from_source_velocity * cv::Vec2d(30, 10) * speed;
    const auto cell = copy.columns.motion.at(3, 4);
    EXPECT_NEAR(cell[0], expected[0], 1e-3);
    EXPECT_NEAR(cell[1], expected[1], 1e-3);
    EXPECT_NEAR(cell[2], expected[0] * expected[0], 0.01);
    EXPECT_NEAR(cell[3], expected[1] * expected[1], 0.01);
    EXPECT_NEAR(cell[4], expected[0] * expected[1], 0.01);
  }
  EXPECT_EQ(mirrored.size(), 2u);
}

TEST_F(ScaledStore, HoldsExactlyAsManyPatchesAndIsWhole) {
  const store::Store store = scaled("exact.store", {.patches = 1234, .window = {160, 120}});
  const store::Snapshot snapshot = store.snapshot();
  EXPECT_TRUE(snapshot.verify().empty());
  const query::SearchBase base = query::open_search(snapshot);
  EXPECT_EQ(base.table.size(), 1234u);
  EXPECT_GT(snapshot.clips().size(), 2u);
  for (const store::ClipId id : snapshot.clips()) {
    const store::ClipRecord& record = snapshot.clip(id);
    const auto by_variant = nlohmann::json::parse(record.metadata).at("patches");
    std::uint64_t sum = 0;
    for (const auto& count : by_variant) sum += count.get<std::uint64_t>();
    EXPECT_EQ(sum, record.rows);
    EXPECT_EQ(record.frames.frames, 5u);
    EXPECT_EQ(record.flow.frames, 4u);
  }
}

TEST_F(ScaledStore, WordsAreThoseThatAnIndexBuildWouldGive) {
  const store::Store store = scaled("words.store", {.patches = 600, .window = {160, 120}});
  const store::Snapshot snapshot = store.snapshot();
  const vision::Codebook codebook = stored::read_codebook(snapshot);
  const auto variants = kSettings.variants();
  const store::ClipId id = snapshot.clips()[0];
  const query::PatchPoints points(snapshot.clip(id), kSettings, variants,
                                  stored::read_clip_patches(snapshot, kSettings, variants, id));
  std::vector<std::vector<vision::Descriptor>> descriptors;
  for (const auto& sheet : points.sheets())
    descriptors.push_back(points.describe(sheet, stored::average_image(snapshot, id)));
  EXPECT_EQ(points.words(codebook, descriptors), stored::kPatchWords.read(snapshot, id, 1));
}

TEST_F(ScaledStore, IsTheSameForASeedWhateverTheThreads) {
  const ScaleOptions options{.patches = 900, .window = {160, 120}};
  std::string first;
  for (const std::size_t threads : {1, 2, 5}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    const std::string digest = scaled("threads" + std::to_string(threads), options).snapshot().digest();
    if (first.empty()) first = digest;
    EXPECT_EQ(digest, first) << threads << " threads";
  }
  ScaleOptions other = options;
  other.seed = 2;
  EXPECT_NE(scaled("seed2", other).snapshot().digest(), first);
}

TEST_F(ScaledStore, ASmallerOneIsTheBeginningOfALarger) {
  const store::Store small = scaled("small.store", {.patches = 500, .window = {160, 120}}),
                     large = scaled("large.store", {.patches = 1500, .window = {160, 120}});
  const auto few = stored::read_patch_table(small.snapshot()).words,
             many = stored::read_patch_table(large.snapshot()).words;
  ASSERT_EQ(few.size(), 500u);
  ASSERT_EQ(many.size(), 1500u);
  EXPECT_TRUE(std::ranges::equal(few.bytes(), many.bytes().first(few.bytes().size())));
}

TEST_F(ScaledStore, AClipThatIsNotThereIsAnError) {
  EXPECT_THROW(generate(source(), {.clips = {"nowhere.mp4"}}, [](JitteredClip&&, std::uint64_t) {}), Error);
}

}  // namespace
}  // namespace freshet::bench
