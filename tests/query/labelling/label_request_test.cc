#include "query/labelling/label_request.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "query/index/index_builder.h"
#include "tests/stored/made_store.h"

namespace freshet::query {
namespace {

MotionGuide rightwards(cv::Size picture) {
  return {.direction = cv::Mat(picture, CV_32FC2, cv::Scalar(1, 0))};
}

TEST(LabelRequest, AGuideWithDirectionsHoldsAndIsNotGuessed) {
  LabelRequest request;
  EXPECT_TRUE(may_guess(request));
  EXPECT_FALSE(guide_overrules_direction(request));
  request.options.candidates.direction_deg = 90;
  EXPECT_FALSE(may_guess(request));
  EXPECT_FALSE(guide_overrules_direction(request));
  request.options.guide = rightwards({8, 8});
  EXPECT_TRUE(guide_overrules_direction(request));
  EXPECT_FALSE(may_guess(request));
  request.options.candidates.direction_deg.reset();
  EXPECT_FALSE(may_guess(request));
  request.options.guide = {};
  request.guesses = false;
  EXPECT_FALSE(may_guess(request));
}

TEST(LabelRequest, SaysScaleAndDurationAndGuessesOnlyWhereNobodySays) {
  const ScratchFolder folder;
  store::Store store = made_store(folder.path() / "a.store", some_clips());
  build_index(store);
  const store::Snapshot snapshot = store.snapshot();
  const SearchBase base = open_search(snapshot);
  cv::Mat picture;
  cv::cvtColor(made_texture(11), picture, cv::COLOR_GRAY2BGR);
  const cv::Mat matte(picture.size(), CV_8U, cv::Scalar(255));

  LabelRequest request{.duration_s = 0.5};
  request.options.candidates.k = 5;
  request.options.candidates.direction_deg = 90;
  request.options.guide = rightwards(picture.size());
  const PreparedLabelling asked = prepare(snapshot, base, picture, matte, request);
  EXPECT_EQ(asked.options.piece_scale, 1);
  EXPECT_EQ(asked.options.candidates.min_duration_s, 0.5);
  EXPECT_FALSE(asked.options.candidates.direction_deg);
  EXPECT_EQ(asked.guess, "");

  // One direction is a price in a wide search, and a condition in a narrow one.
  request.options.guide = {};
  const PreparedLabelling wide = prepare(snapshot, base, picture, matte, request);
  EXPECT_FALSE(wide.options.candidates.direction_deg);
  ASSERT_FALSE(wide.options.guide.direction.empty());
  EXPECT_LT(cv::norm(wide.options.guide.direction.at<cv::Vec2f>(3, 5) - cv::Vec2f(0, -1)), 1e-6);
  EXPECT_FALSE(guide_of_animation(request, picture.size()).direction.empty());
  request.options.hint_search = HintSearch::kNarrow;
  const PreparedLabelling narrow = prepare(snapshot, base, picture, matte, request);
  EXPECT_EQ(narrow.options.candidates.direction_deg, 90);
  EXPECT_TRUE(narrow.options.guide.direction.empty());
  EXPECT_TRUE(guide_of_animation(request, picture.size()).empty());
  request.options.hint_search = HintSearch::kWide;

  request.options.candidates.direction_deg.reset();
  request.options.guide = {.speed = cv::Mat(picture.size(), CV_32F, cv::Scalar(40))};
  request.piece_scale = 2;
  const PreparedLabelling guessed = prepare(snapshot, base, picture, matte, request);
  EXPECT_EQ(guessed.options.piece_scale, 2);
  EXPECT_NE(guessed.guess, "");
  EXPECT_FALSE(guessed.options.guide.speed.empty()) << "a speed that was asked stays";
  EXPECT_EQ(guessed.options.hint_search, HintSearch::kNarrow) << "what is guessed turns nothing";
  EXPECT_TRUE(window_of({{0, 0}, 40}, guessed.options.guide, 0).is_any()) << "and a speed narrows nothing";
  EXPECT_TRUE(guide_of_animation(request, picture.size()).direction.empty());
}

}  // namespace
}  // namespace freshet::query
