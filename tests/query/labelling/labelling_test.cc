#include "query/labelling/labelling.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <fstream>
#include <type_traits>
#include <utility>

#include "freshet/error.h"
#include "query/costs/stored_features.h"
#include "query/index/index_builder.h"
#include "query/labelling/contact_sheet.h"
#include "query/labelling/label_map.h"
#include "tests/harness/fault.h"
#include "tests/stored/made_store.h"

namespace freshet::query {
namespace {

// What borrows a base must not be given a temporary one.
template <class Base>
concept Searchable = requires(const store::Snapshot& snapshot, Base&& base, const cv::Mat& picture) {
  search_candidates(snapshot, std::forward<Base>(base), picture, picture, LabelOptions{});
};
template <class Base>
concept Labellable = requires(const store::Snapshot& snapshot, Base&& base, const cv::Mat& picture) {
  label(snapshot, std::forward<Base>(base), picture, picture);
};
static_assert(Searchable<const SearchBase&> && !Searchable<SearchBase>);
static_assert(Labellable<const SearchBase&> && !Labellable<SearchBase>);
static_assert(
    !std::is_constructible_v<LabellingMemo, cache::ResultCache&, const store::Snapshot&, SearchBase>);
static_assert(!std::is_constructible_v<StoredFeatures, const store::Snapshot&, vision::Settings,
                                       const stored::PatchTable&>);
static_assert(!std::is_constructible_v<StoredFeatures, const store::Snapshot&, const vision::Settings&,
                                       stored::PatchTable>);

// One indexed store for all tests here; none of them writes to it.
class OnAStore : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ScratchFolder;
    store::Store store = made_store(folder_->path() / "a.store", some_clips());
    build_index(store, {.flann = {FlannKind::kKdTree}});
    snapshot_ = new store::Snapshot(store.snapshot());
    base_ = new SearchBase(open_search(*snapshot_));
    table_ = &base_->table;
  }
  static void TearDownTestSuite() {
    delete base_;
    delete snapshot_;
    delete folder_;
  }
  static cv::Mat picture(std::uint64_t texture) {
    cv::Mat bgr;
    cv::cvtColor(made_texture(texture), bgr, cv::COLOR_GRAY2BGR);
    return bgr;
  }
  static cv::Mat whole_matte() { return cv::Mat(144, 192, CV_8U, cv::Scalar(255)); }
  static std::string clip_of(stored::Row row) {
    return snapshot_->clip(table_->clips[table_->clip[row]]).name;
  }
  static Error error_of(const CandidateOptions& options) {
    try {
      filter_rows(*snapshot_, *table_, base_->settings.variants(), options);
    } catch (const Error& error) {
      return error;
    }
    ADD_FAILURE() << "accepted";
    return Error(ErrorKind::kIo, "", "");
  }

  static ScratchFolder* folder_;
  static store::Snapshot* snapshot_;
  static SearchBase* base_;
  static const stored::PatchTable* table_;
};
ScratchFolder* OnAStore::folder_ = nullptr;
store::Snapshot* OnAStore::snapshot_ = nullptr;
SearchBase* OnAStore::base_ = nullptr;
const stored::PatchTable* OnAStore::table_ = nullptr;

using Filter = OnAStore;
using Label = OnAStore;

TEST_F(Filter, KeepsAllWithoutConditions) {
  const Filtered filtered = filter_rows(*snapshot_, *table_, base_->settings.variants(), {});
  EXPECT_EQ(filtered.rows.count(), table_->size());
  ASSERT_EQ(filtered.steps.size(), 1u);
  EXPECT_EQ(filtered.steps[0].clips, 4u);
}

TEST_F(Filter, KeepsTheClassAskedForAndNamesTheOthersWhenThereIsNone) {
  const Filtered filtered =
      filter_rows(*snapshot_, *table_, base_->settings.variants(), {.class_name = "fire"});
  for (stored::Row row = 0; row < table_->size(); ++row) {
    EXPECT_EQ(filtered.rows.allows(row), clip_of(row) == "fire/camp.mp4");
  }
  const Error error = error_of({.class_name = "smoke"});
  EXPECT_EQ(error.kind(), ErrorKind::kNotFound);
  EXPECT_NE(std::string(error.what()).find("fire, water"), std::string::npos) << error.what();
}

TEST_F(Filter, KeepsPatchesThatMoveAsAskedOnTheScreen) {
  // A rotated variant of the fall flows 22.5 degrees off: inside 30 degrees, outside 20.
  for (const auto& [direction, clip] :
       {std::pair{"down", "fall.mp4"}, {"right", "river.mp4"}, {"up", "fire/camp.mp4"}}) {
    CandidateOptions options{.direction_deg = parse_direction(direction)};
    const std::size_t wide =
        filter_rows(*snapshot_, *table_, base_->settings.variants(), options).rows.count();
    options.direction_tolerance_deg = 20;
    const Filtered narrow = filter_rows(*snapshot_, *table_, base_->settings.variants(), options);
    EXPECT_GT(wide, narrow.rows.count());
    EXPECT_GT(narrow.rows.count(), 0u);
    for (stored::Row row = 0; row < table_->size(); ++row) {
      if (narrow.rows.allows(row)) {
        EXPECT_EQ(clip_of(row), clip) << direction;
      }
    }
  }
  EXPECT_EQ(error_of({.direction_deg = 45, .direction_tolerance_deg = 5}).kind(), ErrorKind::kNotFound);
  EXPECT_EQ(error_of({.direction_deg = 1000}).kind(), ErrorKind::kUsage);
}

TEST_F(Filter, NamesTheClipsThatAreTooShort) {
  const Filtered filtered = filter_rows(*snapshot_, *table_, base_->settings.variants(),
                                        {.class_name = "water", .min_duration_s = 3.5});
  EXPECT_EQ(filtered.too_short, std::vector<std::string>{"river.mp4"});
  EXPECT_EQ(filtered.steps.back().clips, 2u);
  EXPECT_NE(std::string(error_of({.min_duration_s = 60}).what()).find("6.00 s"), std::string::npos);
}

TEST(FilterByTimes, AClipLastsAsLongAsItsFramesSayWhateverItsRate) {
  const ScratchFolder folder;
  const vision::Settings settings = made_settings();
  store::Store store =
      made_store(folder.path() / "a.store",
                 {{.name = "as its rate.mp4", .seconds = 2},
                  {.name = "twice as fast.mp4", .seconds = 2, .texture = 2, .frame_s = 0.02}});
  build_index(store);
  const store::Snapshot snapshot = store.snapshot();
  const Filtered filtered = filter_rows(snapshot, stored::read_patch_table(snapshot),
                                        made_settings().variants(), {.min_duration_s = 2});
  EXPECT_EQ(filtered.too_short, std::vector<std::string>{"twice as fast.mp4"});
  EXPECT_EQ(filtered.steps.back().clips, 1u);
}

TEST_F(Filter, LeavesOutClipsByNameAndKnowsWhichThereAre) {
  const Filtered filtered = filter_rows(*snapshot_, *table_, base_->settings.variants(),
                                        {.excluded_clips = {"fall.mp4", "river.mp4"}});
  for (stored::Row row = 0; row < table_->size(); ++row) {
    EXPECT_EQ(filtered.rows.allows(row), clip_of(row) != "fall.mp4" && clip_of(row) != "river.mp4");
  }
  EXPECT_EQ(error_of({.excluded_clips = {"fal.mp4"}}).kind(), ErrorKind::kNotFound);
}

TEST(Direction, IsReadFromWordsAndDegrees) {
  EXPECT_EQ(parse_direction("down"), 270);
  EXPECT_EQ(parse_direction("up-left"), 135);
  EXPECT_EQ(parse_direction("-22.5"), -22.5);
  for (const char* bad : {"", "sideways", "12x", "nan", "1e9"})
    EXPECT_THROW(parse_direction(bad), Error) << bad;
}

TEST_F(Label, FindsAPictureThatIsInTheStore) {
  LabelOptions options;
  options.candidates.k = 20;
  options.costs.lambda = 0;
  const Labelling found = label(*snapshot_, *base_, picture(1), whole_matte(), options);
  ASSERT_EQ(found.assignment.clips.size(), 1u);
  EXPECT_EQ(found.assignment.clips[0].name, "fall.mp4");
  EXPECT_EQ(found.assignment.clips[0].licence, "CC0");
  for (const AssignedPiece& piece : found.assignment.pieces) {
    EXPECT_EQ(piece.patch, piece.corner);
    EXPECT_EQ(piece.variant, vision::Variant{});
    EXPECT_EQ(piece.score, 1);
  }
  EXPECT_NEAR(found.assignment.energy, 0, 1e-6);
  EXPECT_NEAR(found.assignment.lower_bound, 0, 1e-6);
}

TEST_F(Label, TakesOnlyWhatTheConditionsAllow) {
  LabelOptions options;
  options.candidates.k = 30;
  options.candidates.excluded_clips = {"fall.mp4"};
  options.candidates.class_name = "water";
  const Labelling found = label(*snapshot_, *base_, picture(1), whole_matte(), options);
  EXPECT_LE(found.assignment.lower_bound, found.assignment.energy);
  EXPECT_GE(found.assignment.gap(), 0);
  for (const AssignedClip& clip : found.assignment.clips) {
    EXPECT_NE(clip.name, "fall.mp4");
    EXPECT_EQ(clip.class_name, "water");
  }
}

TEST_F(Label, IsTheSameForAnyNumberOfThreadsAndEveryMinimizerRuns) {
  for (const Minimizer minimizer : {Minimizer::kTrwS, Minimizer::kAlphaExpansion, Minimizer::kIcm}) {
    LabelOptions options;
    options.candidates.k = 30;
    options.candidates.excluded_clips = {"river.mp4"};
    options.minimizer = minimizer;
    std::vector<Assignment> found;
    for (const int threads : {1, 2, 8}) {
      const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
      found.push_back(label(*snapshot_, *base_, picture(2), whole_matte(), options).assignment);
    }
    EXPECT_EQ(found[0], found[1]);
    EXPECT_EQ(found[0], found[2]);
    EXPECT_EQ(found[0].minimizer, name_of(minimizer));
  }
}

TEST_F(Label, SaysWhenPiecesHaveFewerCandidatesThanAskedFor) {
  LabelOptions options;
  options.candidates.k = 5000;
  const CandidateSearch search = search_candidates(*snapshot_, *base_, picture(3), whole_matte(), options);
  EXPECT_EQ(search.candidates.counts[0], table_->size());
  EXPECT_EQ(search.candidates.notes.size(), 1u);
  options.candidates.k = 0;
  EXPECT_THROW(search_candidates(*snapshot_, *base_, picture(3), whole_matte(), options), Error);
}

TEST_F(Label, SearchesThroughFlannWhenAsked) {
  LabelOptions options;
  options.candidates.k = 10;
  const SearchBase approximate = open_search(*snapshot_, {.flann = FlannKind::kKdTree});
  const CandidateSearch search =
      search_candidates(*snapshot_, approximate, picture(4), whole_matte(), options);
  for (std::size_t piece = 0; piece < search.target.size(); ++piece) {
    EXPECT_EQ(search.candidates.scores_of(piece)[0], 1);
  }
  fault_of(ErrorKind::kNotFound, [&] { open_search(*snapshot_, {.flann = FlannKind::kKMeans}); });
}

TEST_F(Label, StopsWhenAsked) {
  std::stop_source source;
  fault_of(ErrorKind::kCancelled, [&] {
    label(
        *snapshot_, *base_, picture(1), whole_matte(), {},
        [&](const Progress& at) {
          if (at.stage == "comparing neighbours") source.request_stop();
        },
        source.get_token());
  });
}

TEST_F(Label, IsShownAsSheetAndMap) {
  LabelOptions options;
  options.candidates.k = 12;
  options.costs.lambda = 0;
  const cv::Mat still = picture(1);
  const Labelling found = label(*snapshot_, *base_, still, whole_matte(), options);
  const cv::Mat sheet =
      contact_sheet(*snapshot_, still, found.search, &found.labels, {.pieces = 5, .candidates = 3});
  EXPECT_EQ(sheet.type(), CV_8UC3);
  // The best candidate is the piece itself: the two stand side by side, twice as large.
  const cv::Mat piece = sheet(cv::Rect(6, 6, 96, 96)), best = sheet(cv::Rect(108, 6, 96, 96));
  cv::Mat twice;
  cv::resize(still(cv::Rect(0, 0, 48, 48)), twice, {}, 2, 2, cv::INTER_CUBIC);
  EXPECT_EQ(cv::norm(piece, twice, cv::NORM_INF), 0);
  EXPECT_LE(cv::norm(piece, best, cv::NORM_INF), 1);
  const cv::Mat map = label_map(still, nullptr, found.assignment);
  EXPECT_GT(map.rows, still.rows);
  EXPECT_GE(map.cols, 480);
  // Of 41 clips forty have a line, and a line says how many have none.
  Assignment many = found.assignment;
  many.clips.resize(40, many.clips[0]);
  const int forty = label_map(still, nullptr, many).rows;
  many.clips.resize(41, many.clips[0]);
  const cv::Mat one_more = label_map(still, nullptr, many);
  many.clips.resize(60, many.clips[0]);
  const cv::Mat twenty_more = label_map(still, nullptr, many);
  EXPECT_GT(one_more.rows, forty);
  ASSERT_EQ(twenty_more.size(), one_more.size());
  EXPECT_GT(cv::norm(twenty_more, one_more, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace freshet::query
