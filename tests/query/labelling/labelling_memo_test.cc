#include "query/labelling/labelling_memo.h"

#include <gtest/gtest.h>

#include <fstream>

#include "query/index/index_builder.h"
#include "query/labelling/labelling.h"
#include "tests/stored/made_store.h"

namespace freshet::query {
namespace {

namespace fs = std::filesystem;

class Recall : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    store_folder_ = new ScratchFolder;
    store::Store store = made_store(store_folder_->path() / "a.store", some_clips());
    build_index(store, {.flann = {FlannKind::kKdTree}});
    snapshot_ = new store::Snapshot(store.snapshot());
    base_ = new SearchBase(open_search(*snapshot_, {.built_late = true}));
    cv::cvtColor(made_texture(1), picture_, cv::COLOR_GRAY2BGR);
    matte_ = cv::Mat(picture_.size(), CV_8U, cv::Scalar(255));
  }
  static void TearDownTestSuite() {
    delete base_;
    delete snapshot_;
    delete store_folder_;
  }

  /// Down on the whole picture; in its lower right corner as given.
  static LabelOptions options(double corner_deg = 270) {
    LabelOptions options;
    options.hint_search = HintSearch::kNarrow;
    options.candidates.k = 12;
    options.candidates.coherent = 3;
    options.guide.direction = cv::Mat(picture_.size(), CV_32FC2, cv::Scalar(0, 1));
    const double angle = corner_deg * CV_PI / 180;
    options.guide.direction(cv::Rect(144, 96, 48, 48)).setTo(cv::Scalar(std::cos(angle), -std::sin(angle)));
    return options;
  }
  static Labelling cold(const LabelOptions& options) {
    return label(*snapshot_, *base_, picture_, matte_, options);
  }
  /// With what is in the folder; reuse_ and notices_ say what was.
  Labelling warm(const LabelOptions& options, const SearchBase& base = *base_) {
    cache::ResultCache cache(folder_.path());
    LabellingMemo memo(cache, *snapshot_, base);
    Labelling labelling = label(*snapshot_, base, picture_, matte_, options, {}, {}, &memo);
    cache.finish();
    reuse_ = memo.reuse();
    notices_ = cache.take_notices();
    return labelling;
  }
  static void expect_same(const Labelling& a, const Labelling& b) {
    EXPECT_EQ(a.search.candidates.rows, b.search.candidates.rows);
    EXPECT_EQ(a.search.candidates.scores, b.search.candidates.scores);
    EXPECT_EQ(a.search.candidates.opened, b.search.candidates.opened);
    EXPECT_EQ(a.search.candidates.notes, b.search.candidates.notes);
    EXPECT_EQ(a.labels, b.labels);
    EXPECT_EQ(a.assignment, b.assignment);  // energy and bound as well
    EXPECT_EQ(a.iterations, b.iterations);
  }

  const ScratchFolder folder_;
  Reuse reuse_;
  std::vector<std::string> notices_;
  static ScratchFolder* store_folder_;
  static store::Snapshot* snapshot_;
  static SearchBase* base_;
  static inline cv::Mat picture_, matte_;
};
ScratchFolder* Recall::store_folder_ = nullptr;
store::Snapshot* Recall::snapshot_ = nullptr;
SearchBase* Recall::base_ = nullptr;

TEST_F(Recall, AChangedCornerIsLabelledAsIfNothingWereKnown) {
  expect_same(warm(options()), cold(options()));
  EXPECT_EQ(reuse_.reused_pieces, 0u);
  EXPECT_EQ(reuse_.reused_edges, 0u);
  EXPECT_FALSE(reuse_.labels);
  for (const double corner : {0.0, 200.0, 90.0}) {
    const LabelOptions changed = options(corner);
    const Labelling fresh = cold(changed);
    expect_same(warm(changed), fresh);
    EXPECT_LT(reuse_.reused_pieces, reuse_.pieces);
    EXPECT_GT(reuse_.reused_pieces, reuse_.pieces / 2);
    EXPECT_LT(reuse_.reused_edges, reuse_.edges);
    EXPECT_GT(reuse_.reused_edges, reuse_.edges / 3);
    EXPECT_NE(fresh.search.candidates.rows, cold(options()).search.candidates.rows);
  }
  EXPECT_EQ(to_string(Reuse{.pieces = 9, .edges = 12, .reused_pieces = 4, .reused_edges = 3}),
            "4 of 9 pieces' candidates and 3 of 12 edges reused");
}

TEST_F(Recall, InAWideSearchAStrokeChangesPricesAndNothingIsSearchedAgain) {
  LabelOptions asked = options();
  asked.hint_search = HintSearch::kWide;
  expect_same(warm(asked), cold(asked));
  LabelOptions changed = options(90);
  changed.hint_search = HintSearch::kWide;
  const Labelling fresh = cold(changed);
  expect_same(warm(changed), fresh);
  EXPECT_FALSE(reuse_.labels);
  EXPECT_EQ(reuse_.reused_pieces, reuse_.pieces);
  EXPECT_GT(reuse_.reused_edges, reuse_.edges / 3);
  EXPECT_LT(reuse_.reused_edges, reuse_.edges);
}

TEST_F(Recall, TheSameAgainNeedsNoIndexNoTableAndNoSolver) {
  const Labelling first = warm(options());
  SearchBase base = open_search(*snapshot_);
  base.index.reset();  // a search would end the test
  class NoIndex final : public CandidateIndex {
    std::size_t rows() const override { return 0; }
    std::vector<std::vector<ScoredPatch>> search(std::span<const PieceQuery> queries, std::size_t,
                                                 const SearchFilter&) const override {
      EXPECT_TRUE(queries.empty());
      return {};
    }
  };
  base.index = std::make_unique<NoIndex>();
  const Labelling again = warm(options(), base);
  expect_same(again, first);
  EXPECT_TRUE(reuse_.labels);
  EXPECT_EQ(reuse_.reused_pieces, reuse_.pieces);
  EXPECT_EQ(to_string(reuse_), "the whole labelling reused");
}

TEST_F(Recall, EachOptionThatMattersMakesOtherLabels) {
  warm(options());
  std::vector<LabelOptions> others(7, options());
  others[0].candidates.k = 13;
  others[1].candidates.coherent = 4;
  others[2].candidates.excluded_clips = {"fall.mp4"};
  others[3].minimizer = Minimizer::kIcm;
  others[4].costs.form = CostForm::kPower;
  others[5].guide.tolerance_deg = 120;
  others[6].hint_search = HintSearch::kWide;
  // Field by field: a weight that is added does not compile until it is tried here.
  LabelOptions changed;
  auto& [form, lambda, sigma, rho, vote] = changed.costs;
  auto& [direction, speed, unsteady] = changed.guide_costs;
  auto& [overlap, crowd] = changed.reuse;
  for (double* const weight :
       {&lambda, &sigma, &rho, &vote, &direction, &speed, &unsteady, &overlap, &crowd}) {
    changed = options();
    *weight = 2 * *weight + 1;
    others.push_back(changed);
  }
  for (std::size_t i = 0; i < others.size(); ++i) {
    SCOPED_TRACE(i);
    expect_same(warm(others[i]), cold(others[i]));
    EXPECT_FALSE(reuse_.labels);
  }
}

TEST_F(Recall, DamagedPacksAreLeftOutWithANotice) {
  warm(options());
  for (const auto& entry : fs::directory_iterator(folder_.path())) {
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(-20, std::ios::end);
    file.put('\x55');
  }
  expect_same(warm(options(90)), cold(options(90)));
  ASSERT_EQ(notices_.size(), 1u);
  EXPECT_NE(notices_[0].find("damaged"), std::string::npos);
  EXPECT_EQ(reuse_.reused_pieces, 0u);
}

// Bytes whose hash is right, and that are yet none of ours.
TEST_F(Recall, EntriesThatCannotBeAreComputedAgain) {
  const LabelOptions asked = options();
  const Labelling fresh = cold(asked);
  cache::ResultCache cache(folder_.path());
  LabellingMemo memo(cache, *snapshot_, *base_);
  const cache::Key key = memo.solution_key(fresh.search.target, fresh.search.candidates, asked.costs,
                                           asked.guide_costs, {}, asked.minimizer, asked.max_iterations);
  Solution wrong{fresh.labels, 1, 0, 3};
  wrong.labels[2] = 1000;
  memo.keep_solution(key, wrong);
  expect_same(label(*snapshot_, *base_, picture_, matte_, asked, {}, {}, &memo), fresh);
  EXPECT_FALSE(memo.reuse().labels);
}

TEST_F(Recall, AnotherStoreHasNothingInCommon) {
  warm(options());
  const ScratchFolder other;
  auto clips = some_clips();
  clips[3].texture = 9;
  store::Store store = made_store(other.path() / "b.store", clips);
  build_index(store);
  const store::Snapshot snapshot = store.snapshot();
  const SearchBase base = open_search(snapshot);
  cache::ResultCache cache(folder_.path());
  LabellingMemo memo(cache, snapshot, base);
  label(snapshot, base, picture_, matte_, options(), {}, {}, &memo);
  EXPECT_EQ(memo.reuse().reused_pieces, 0u);
  EXPECT_EQ(memo.reuse().reused_edges, 0u);
}

TEST_F(Recall, AnswersOfAnApproximateIndexAreNotKept) {
  const SearchBase base = open_search(*snapshot_, {.flann = FlannKind::kKdTree});
  LabelOptions asked = options();
  asked.guide = {};
  warm(asked, base);
  warm(asked, base);
  EXPECT_EQ(reuse_.reused_pieces, 0u);
}

TEST_F(Recall, ALateIndexAnswersAsAnEarlyOne) {
  const SearchBase early = open_search(*snapshot_);
  const Labelling a = label(*snapshot_, early, picture_, matte_, options());
  expect_same(cold(options()), a);
}

// A stroke far away bends directions a little everywhere: most windows stay.
TEST(MotionWindow, MovesInStepsOfItsTolerance) {
  MotionGuide guide;
  guide.direction = cv::Mat(1, 1, CV_32FC2);
  std::size_t windows = 1;
  const auto at = [&](double degrees) {
    const double angle = degrees * CV_PI / 180;
    return window_of({{static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))}, 20}, guide,
                     0);
  };
  MotionWindow last = at(0);
  for (double degrees = 0; degrees < 90; degrees += 0.1) {
    const MotionWindow window = at(degrees);
    const double middle = std::atan2(window.v, window.u) * 180 / CV_PI;
    EXPECT_NEAR(middle, degrees, guide.tolerance_deg / 12 + 1e-4);
    windows += window.u != last.u || window.v != last.v;
    last = window;
  }
  EXPECT_EQ(windows, 19u);
  EXPECT_NEAR(last.max_speed / last.min_speed, guide.speed_ratio * guide.speed_ratio, 1e-4);
}

}  // namespace
}  // namespace freshet::query
