#include "query/labelling/motion_guess.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "freshet/error.h"
#include "query/index/index_builder.h"
#include "tests/stored/made_store.h"

namespace freshet::query {
namespace {

/// Stripes along an axis, degrees anticlockwise from level, 12 px apart.
cv::Mat stripes(double axis_deg, cv::Size size = {192, 144}) {
  const double across = (axis_deg + 90) * std::numbers::pi / 180;
  cv::Mat picture(size, CV_8UC3);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      picture.at<cv::Vec3b>(y, x) = cv::Vec3b::all(static_cast<std::uint8_t>(
          128 + 80 * std::sin((x * std::cos(across) - y * std::sin(across)) * std::numbers::pi / 6)));
  return picture;
}

cv::Mat grey(const cv::Mat& texture) {
  cv::Mat picture;
  cv::cvtColor(texture, picture, cv::COLOR_GRAY2BGR);
  return picture;
}

cv::Mat everywhere(const cv::Mat& picture) { return cv::Mat(picture.size(), CV_8U, cv::Scalar(255)); }

class GuessedMotion : public testing::Test {
 protected:
  GuessedMotion()
      : store_(made_store(folder_.path() / "a.store",
                          {{.name = "fall", .motion = {0, 60}, .texture = 1},
                           {.name = "campfire", .class_name = "fire", .motion = {0, -50}, .texture = 3},
                           {.name = "torch", .class_name = "fire", .motion = {5, -50}, .texture = 5},
                           {.name = "sky", .class_name = "clouds", .motion = {40, 0}, .texture = 2},
                           {.name = "geyser", .class_name = "odd", .motion = {0, -40}, .texture = 6},
                           {.name = "rain", .class_name = "odd", .motion = {0, 40}, .texture = 7}})) {
    build_index(store_);
    snapshot_ = store_.snapshot();
    base_ = open_search(*snapshot_);
  }
  MotionGuess guess(const cv::Mat& picture, const std::string& class_name, const GuessOptions& options = {},
                    const std::vector<std::string>& excluded = {}) {
    LabelOptions search;
    search.candidates.class_name = class_name;
    search.candidates.excluded_clips = excluded;
    search.candidates.k = 10;
    const cv::Mat matte = everywhere(picture);
    return guess_motion(*snapshot_, search_candidates(*snapshot_, base_, picture, matte, search), picture,
                        matte, options);
  }

  ScratchFolder folder_;
  store::Store store_;
  std::optional<store::Snapshot> snapshot_;
  SearchBase base_;
};

const GuessOptions kPullAlone{.edges = 0};

void expect_everywhere(const MotionGuess& guess, cv::Vec2f direction, double tolerance_deg) {
  ASSERT_FALSE(guess.guide.empty()) << guess.report;
  const double minimum = std::cos(tolerance_deg * std::numbers::pi / 180);
  for (const PieceGuess& piece : guess.pieces) EXPECT_GE(piece.direction.dot(direction), minimum);
  for (int y = 0; y < guess.guide.direction.rows; ++y)
    for (int x = 0; x < guess.guide.direction.cols; ++x) {
      const cv::Vec2f& way = guess.guide.direction.at<cv::Vec2f>(y, x);
      ASSERT_GE(way.dot(direction), minimum - 1e-5) << x << " " << y;
      ASSERT_NEAR(cv::norm(way), 1, 1e-5);
    }
}

TEST_F(GuessedMotion, GoesAsTheClassOfTheStoreGoes) {
  expect_everywhere(guess(grey(made_texture(9)), "fire", kPullAlone), {0, -1}, 1);
  expect_everywhere(guess(grey(made_texture(9)), "water", kPullAlone), {0, 1}, 1);
}

TEST_F(GuessedMotion, IsNotDaredWhereAClassGoesLevelOrBothWays) {
  for (const char* class_name : {"clouds", "odd"}) {
    const MotionGuess found = guess(grey(made_texture(9)), class_name);
    EXPECT_TRUE(found.guide.empty());
    EXPECT_NE(found.report.find("no direction"), std::string::npos) << found.report;
    EXPECT_NE(found.report.find(class_name), std::string::npos) << found.report;
    for (const PieceGuess& piece : found.pieces) EXPECT_EQ(piece.direction, cv::Vec2f(0, 0));
  }
}

TEST_F(GuessedMotion, ClipsLeftOutDoNotPull) {
  expect_everywhere(guess(grey(made_texture(9)), "odd", kPullAlone, {"rain"}), {0, -1}, 1);
  expect_everywhere(guess(grey(made_texture(9)), "odd", kPullAlone, {"geyser"}), {0, 1}, 1);
}

TEST_F(GuessedMotion, IsTurnedByTheAxisOfTexture) {
  const float s = std::sqrt(0.5f);
  expect_everywhere(guess(stripes(45), "fire"), {s, -s}, 20);
  expect_everywhere(guess(stripes(135), "fire"), {-s, -s}, 20);
  expect_everywhere(guess(stripes(45), "water"), {-s, s}, 20);
}

TEST_F(GuessedMotion, IsSurerAlongThanAcross) {
  const MotionGuess along = guess(stripes(90), "fire"), plain = guess(stripes(90), "fire", kPullAlone),
                    across = guess(stripes(0), "fire");
  EXPECT_GT(along.pieces[0].certainty, plain.pieces[0].certainty);
  EXPECT_LT(along.guide.tolerance_deg, plain.guide.tolerance_deg);
  EXPECT_LT(across.pieces[0].certainty, plain.pieces[0].certainty);
  EXPECT_TRUE(across.guide.empty()) << across.report;  // left or right?
}

TEST_F(GuessedMotion, TextureAloneMakesNoSign) {
  EXPECT_TRUE(guess(stripes(90), "fire", {.gravity = 0}).guide.empty());
  EXPECT_TRUE(guess(stripes(90), "clouds").guide.empty());
}

TEST_F(GuessedMotion, IsTheSameForAnyNumberOfThreads) {
  const cv::Mat picture = stripes(60);
  std::optional<MotionGuess> first;
  for (const std::size_t threads : {1, 2, 8}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    cv::setNumThreads(static_cast<int>(threads));
    MotionGuess found = guess(picture, "fire", {.min_certainty = 0.05});
    if (!first) {
      EXPECT_FALSE(found.guide.empty());
      first = std::move(found);
      continue;
    }
    EXPECT_EQ(found.report, first->report);
    EXPECT_EQ(cv::norm(found.guide.direction, first->guide.direction, cv::NORM_INF), 0);
    EXPECT_EQ(found.guide.tolerance_deg, first->guide.tolerance_deg);
  }
  cv::setNumThreads(-1);
}

TEST_F(GuessedMotion, IsAsLargeAsThePictureThatIsGiven) {
  const cv::Mat picture = stripes(45);
  LabelOptions options;
  options.candidates.class_name = "fire";
  const CandidateSearch search = search_candidates(*snapshot_, base_, picture, everywhere(picture), options);
  cv::Mat large;
  cv::resize(picture, large, {}, 2, 2);
  const MotionGuess found = guess_motion(*snapshot_, search, large, everywhere(large));
  ASSERT_EQ(found.guide.direction.size(), large.size());
  const float s = std::sqrt(0.5f);
  expect_everywhere(found, {s, -s}, 20);
}

TEST_F(GuessedMotion, PicturesAndMattesOfOtherTypesAreRefused) {
  const cv::Mat picture = stripes(45);
  const CandidateSearch search = search_candidates(*snapshot_, base_, picture, everywhere(picture), {});
  EXPECT_THROW(guess_motion(*snapshot_, search, picture, cv::Mat(10, 10, CV_8U)), Error);
  EXPECT_THROW(guess_motion(*snapshot_, search, cv::Mat(144, 192, CV_8U), everywhere(picture)), Error);
}

}  // namespace
}  // namespace freshet::query
