#include "query/search/motion_guide.h"

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "query/costs/guide_costs.h"
#include "query/index/index_builder.h"
#include "query/labelling/labelling.h"
#include "tests/stored/made_store.h"

namespace freshet::query {
namespace {

Target two_pieces() {
  Target target;
  target.picture = {72, 48};
  target.corners = {{0, 0}, {24, 0}};
  target.places = {{0, 0}, {1, 0}};
  return target;
}

TEST(MotionGuide, AsksOfAPieceTheMeanOverItsFluid) {
  MotionGuide guide;
  guide.direction = cv::Mat(48, 72, CV_32FC2, cv::Scalar(0, 0));
  guide.direction(cv::Rect(0, 0, 30, 48)).setTo(cv::Scalar(1, 0));
  guide.direction(cv::Rect(60, 0, 12, 48)).setTo(cv::Scalar(0, -1));
  guide.speed = cv::Mat(48, 72, CV_32F, cv::Scalar(-1));
  guide.speed(cv::Rect(0, 0, 72, 10)).setTo(20);
  guide.speed(cv::Rect(0, 10, 72, 10)).setTo(80);
  cv::Mat matte(48, 72, CV_8U, cv::Scalar(255));
  auto asked = asked_motion(guide, two_pieces(), matte);
  EXPECT_EQ(asked[0].direction, cv::Vec2f(1, 0));
  EXPECT_NEAR(asked[0].speed, 40, 1e-3);  // geometric
  EXPECT_GT(asked[1].direction[0], 0);    // 6 columns to the right, 12 up
  EXPECT_NEAR(asked[1].direction[1] / asked[1].direction[0], -2, 1e-4);
  matte(cv::Rect(0, 0, 60, 48)).setTo(0);  // the second piece's fluid goes up, the first has none
  asked = asked_motion(guide, two_pieces(), matte);
  EXPECT_EQ(asked[0].direction, cv::Vec2f(1, 0));
  EXPECT_EQ(asked[1].direction, cv::Vec2f(0, -1));
}

TEST(MotionGuide, AsksNothingWhereItsMapsSayNothing) {
  MotionGuide guide;
  guide.direction = cv::Mat(48, 72, CV_32FC2, cv::Scalar(0, 0));
  const auto asked = asked_motion(guide, two_pieces(), cv::Mat(48, 72, CV_8U, cv::Scalar(255)));
  EXPECT_TRUE(window_of(asked[0], guide, 0).is_any());
}

TEST(MotionGuide, OpensStepByStepUntilNothingIsAsked) {
  MotionGuide guide{.tolerance_deg = 20, .speed_ratio = 1.25};
  const PieceMotion asked{{0, 1}, 50};
  const MotionWindow first = window_of(asked, guide, 0);
  EXPECT_TRUE(first.admits(0, 50));
  EXPECT_TRUE(first.admits(17, 47));      // 19.9 degrees
  EXPECT_FALSE(first.admits(18.5f, 46));  // 21.9
  EXPECT_FALSE(first.admits(0, 63));
  EXPECT_FALSE(first.admits(0, 39));
  EXPECT_FALSE(first.admits(0, -50));
  MotionWindow last = first;
  int steps = 0;
  while (!last.is_any()) {
    const MotionWindow wider = window_of(asked, guide, ++steps);
    EXPECT_LE(wider.min_cosine, last.min_cosine);
    EXPECT_LE(wider.min_speed, last.min_speed);
    EXPECT_GE(wider.max_speed, last.max_speed);
    last = wider;
    ASSERT_LT(steps, 20);
  }
  EXPECT_GT(steps, 3);
  EXPECT_FALSE(first.admits(std::nanf(""), 50));  // a column may hold anything
}

TEST(MotionGuide, RefusesMapsOfAnotherSizeAndNumbersOutOfRange) {
  const cv::Mat matte(48, 72, CV_8U, cv::Scalar(255));
  MotionGuide guide;
  guide.speed = cv::Mat(40, 72, CV_32F, cv::Scalar(1));
  EXPECT_THROW(asked_motion(guide, two_pieces(), matte), Error);
  guide.speed = cv::Mat(48, 72, CV_32F, cv::Scalar(1));
  guide.speed_ratio = 0.5;
  EXPECT_THROW(asked_motion(guide, two_pieces(), matte), Error);
  guide.speed_ratio = 2;
  guide.tolerance_deg = -1;
  EXPECT_THROW(asked_motion(guide, two_pieces(), matte), Error);
}

class Guided : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ScratchFolder;
    store::Store store = made_store(folder_->path() / "a.store", some_clips());
    build_index(store);
    snapshot_ = new store::Snapshot(store.snapshot());
    base_ = new SearchBase(open_search(*snapshot_));
  }
  static void TearDownTestSuite() {
    delete base_;
    delete snapshot_;
    delete folder_;
  }
  static cv::Mat picture() {
    cv::Mat bgr;
    cv::cvtColor(made_texture(9), bgr, cv::COLOR_GRAY2BGR);
    return bgr;
  }
  static MotionGuide asking(cv::Vec2f direction, double speed) {
    MotionGuide guide;
    guide.direction = cv::Mat(144, 192, CV_32FC2, cv::Scalar(direction[0], direction[1]));
    if (speed >= 0) guide.speed = cv::Mat(144, 192, CV_32F, cv::Scalar(speed));
    return guide;
  }
  static CandidateSearch search(const LabelOptions& options) {
    return search_candidates(*snapshot_, *base_, picture(), cv::Mat(144, 192, CV_8U, cv::Scalar(255)),
                             options);
  }
  static ScratchFolder* folder_;
  static store::Snapshot* snapshot_;
  static SearchBase* base_;
};
ScratchFolder* Guided::folder_ = nullptr;
store::Snapshot* Guided::snapshot_ = nullptr;
SearchBase* Guided::base_ = nullptr;

TEST_F(Guided, AWideSearchForbidsNothingAndPutsFirstWhatIsBestWhenItHasPaid) {
  LabelOptions options;
  options.candidates.k = 10;
  options.candidates.coherent = 0;
  options.guide = asking({0, 1}, 30);
  options.guide_costs = {.direction = 0, .speed = 0, .unsteady = 0};
  const CandidateSearch free = search(options);
  options.guide_costs = {.direction = 0.1, .speed = 0.02, .unsteady = 0};
  const CandidateSearch priced = search(options);
  options.guide_costs = {.direction = 100, .speed = 0, .unsteady = 0};
  options.candidates.considered = 1000;
  const CandidateSearch dear = search(options);
  options.guide = {};
  const CandidateSearch unasked = search(options);
  EXPECT_EQ(free.candidates.rows, unasked.candidates.rows) << "what costs nothing changes nothing";
  bool other = false;
  for (std::size_t piece = 0; piece < priced.target.size(); ++piece) {
    const auto rows = priced.candidates.rows_of(piece);
    const auto scores = priced.candidates.scores_of(piece);
    EXPECT_EQ(rows.size(), 10u);
    double last = 2;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double paid = scores[i] - guide_price({{0, 1}, 30}, priced.table().mean_u[rows[i]],
                                                  priced.table().mean_v[rows[i]], 1,
                                                  {.direction = 0.1, .speed = 0.02, .unsteady = 0});
      EXPECT_LE(paid, last + 0.01);  // asked in steps: 30 px/s is not one of them
      last = paid;
    }
    other = other || !std::equal(rows.begin(), rows.end(), free.candidates.rows_of(piece).begin());
    for (const stored::Row row : dear.candidates.rows_of(piece))
      EXPECT_GT(dear.table().mean_v[row], 0) << "there are enough that fall";
  }
  EXPECT_TRUE(other);
}

TEST_F(Guided, PiecesGetOnlyWhatMovesAsAsked) {
  LabelOptions options;
  options.hint_search = HintSearch::kNarrow;
  options.candidates.k = 10;
  options.guide = asking({0, 1}, 30);  // down: the fall at half its size
  const CandidateSearch found = search(options);
  for (std::size_t piece = 0; piece < found.target.size(); ++piece) {
    EXPECT_EQ(found.candidates.opened[piece], 0);
    EXPECT_GE(found.candidates.counts[piece], 10u);
    for (const stored::Row row : found.candidates.rows_of(piece)) {
      EXPECT_GT(found.table().mean_v[row], 20 * std::cos(0.53));
      EXPECT_LE(std::hypot(found.table().mean_u[row], found.table().mean_v[row]), 45.01);
    }
  }
  EXPECT_TRUE(found.candidates.notes.empty());
}

TEST_F(Guided, TolerancesOpenWhereTooFewMoveAsAskedAndANoteSaysSo) {
  LabelOptions options;
  options.hint_search = HintSearch::kNarrow;
  options.candidates.k = 10;
  options.guide = asking({-1, 0}, -1);  // nothing goes left but mirrored rivers
  options.guide.tolerance_deg = 5;
  options.candidates.excluded_clips = {"river.mp4"};
  const CandidateSearch found = search(options);
  for (std::size_t piece = 0; piece < found.target.size(); ++piece) {
    EXPECT_GT(found.candidates.opened[piece], 0);
    EXPECT_GE(found.candidates.counts[piece], 10u);
  }
  ASSERT_EQ(found.candidates.notes.size(), 1u);
  EXPECT_NE(found.candidates.notes[0].find("opened"), std::string::npos);
}

}  // namespace
}  // namespace freshet::query
