#include "synth/animate/forms/seats.h"

#include <gtest/gtest.h>

#include "tests/synth/animate/forms/burning.h"

namespace freshet::synth::animate {
namespace {

const cv::Size kSize(200, 120);

TEST(Seats, TwoFiresAreTwoEachWithItsColumns) {
  const cv::Mat level = cv::max(flame(kSize, {50, 100}, 30, 60), flame(kSize, {150, 90}, 20, 30));
  const std::vector<Seat> seats = seats_of(level);
  ASSERT_EQ(seats.size(), 2);
  EXPECT_NEAR(seats[0].bed, 100, 4);
  EXPECT_NEAR(seats[1].bed, 90, 4);
  EXPECT_NEAR((seats[0].left + seats[0].right) / 2, 50, 2);
  EXPECT_GT(seats[0].share, 2.5 * seats[1].share);
  EXPECT_EQ(seats[0].first, 0);
  EXPECT_EQ(seats[0].last, seats[1].first);
  EXPECT_EQ(seats[1].last, 200);
  const Seat all = together(seats, 200);
  EXPECT_EQ(all.left, seats[0].left);
  EXPECT_EQ(all.right, seats[1].right);
  EXPECT_NEAR(all.share, 1, 1e-6);
}

TEST(Seats, ATipThatCameOffBelongsToTheFireBelow) {
  const cv::Mat level = cv::max(flame(kSize, {100, 110}, 40, 50), flame(kSize, {104, 40}, 10, 15));
  const std::vector<Seat> seats = seats_of(level);
  ASSERT_EQ(seats.size(), 1);
  EXPECT_LT(seats[0].top, 65);
}

TEST(Seats, WhereNothingShinesThereAreNone) { EXPECT_TRUE(seats_of(cv::Mat::zeros(kSize, CV_32F)).empty()); }

TEST(Seats, AreFoundOnFewSamplesInPixelsOfTheWhole) {
  const cv::Mat level =
      cv::max(flame({800, 480}, {200, 400}, 120, 240), flame({800, 480}, {600, 360}, 80, 120));
  const std::vector<Seat> all = seats_of(level), few = seats_reduced(level, 200);
  ASSERT_EQ(few.size(), all.size());
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_NEAR(few[i].bed, all[i].bed, 8);
    EXPECT_NEAR(few[i].left, all[i].left, 8);
    EXPECT_NEAR(few[i].share, all[i].share, 0.02);
  }
  EXPECT_TRUE(seats_reduced(cv::Mat::zeros(1, 3000, CV_32F), 200).empty());
}

}  // namespace
}  // namespace freshet::synth::animate
