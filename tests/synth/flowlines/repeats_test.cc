#include "synth/flowlines/jumps/repeats.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace freshet::synth::flowlines {
namespace {

cv::Mat random_cost(int entries, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat cost(entries + 1, entries, CV_32F);
  random.fill(cost, cv::RNG::UNIFORM, 0.1f, 1.0f);
  return cost;
}

TEST(Repeats, RunsFollowEachOtherAndNoneIsTheSameTwiceInARow) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const int entries = 16;
    Repeats repeats(random_cost(entries, seed), {.min_run = 5, .seed = seed});
    std::int64_t end = 0;
    int before = -1;
    for (int i = 0; i < 200; ++i) {
      const auto run = repeats.next();
      EXPECT_EQ(run.start, end);
      EXPECT_GE(run.length, 5);
      EXPECT_LE(run.first + run.length, entries);
      EXPECT_NE(run.first, before);
      before = run.first;
      end = run.end();
    }
  }
}

TEST(Repeats, TakeCheapJumpsWhenNothingElseCounts) {
  cv::Mat cost(17, 16, CV_32F, cv::Scalar(1));
  cost.at<float>(12, 2) = cost.at<float>(10, 0) = 0.01f;
  Repeats repeats(cost, {.min_run = 4, .freshness = 0, .chance = 0, .seed = 1});
  repeats.next();
  for (int i = 0; i < 10; ++i) {
    repeats.next();
    EXPECT_LT(repeats.jump(), 0.02);
  }
}

TEST(Repeats, GoInAnotherOrderAgainAndAgain) {
  Repeats repeats(random_cost(24, 3), {.min_run = 6, .seed = 3});
  std::set<std::pair<int, int>> different;
  for (int i = 0; i < 60; ++i) {
    const auto run = repeats.next();
    different.insert({run.first, run.length});
  }
  EXPECT_GT(different.size(), 10u);
}

TEST(Repeats, ALoopIsExactlyAsLongAsAsked) {
  const cv::Mat cost = random_cost(14, 8);
  for (const int frames : {12, 13, 47, 200}) {
    const auto runs = cyclic(cost, frames, {.min_run = 5, .seed = 2});
    ASSERT_FALSE(runs.empty()) << frames;
    std::int64_t end = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      EXPECT_EQ(runs[i].start, end);
      EXPECT_GE(runs[i].length, 5);
      EXPECT_LE(runs[i].first + runs[i].length, 14);
      EXPECT_NE(runs[i].first, runs[(i + 1) % runs.size()].first);
      end = runs[i].end();
    }
    EXPECT_EQ(end, frames);
  }
  EXPECT_TRUE(cyclic(cost, 9, {.min_run = 5, .seed = 2}).empty());
}

/// All orders from one first entry, one after another.
double cheapest(const cv::Mat& cost, int frames, int least, int origin, int first, int at) {
  double best = std::numeric_limits<double>::max();
  for (int length = least; first + length <= cost.cols && at + length <= frames; ++length)
    for (int b = 0; b + least <= cost.cols; ++b) {
      if (b == first || std::abs(b - first - length) < 2) continue;
      const double jump = static_cast<double>(cost.at<float>(first + length, b));
      if (at + length == frames) {
        if (b == origin) best = std::min(best, jump);
        continue;
      }
      const double rest = cheapest(cost, frames, least, origin, b, at + length);
      if (rest < std::numeric_limits<double>::max()) best = std::min(best, jump + rest);
    }
  return best;
}

TEST(Repeats, ALoopCostsAsLittleAsExhaustiveSearchFinds) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const cv::Mat cost = random_cost(8, seed);
    const auto runs = cyclic(cost, 14, {.min_run = 3, .chance = 0, .seed = seed});
    ASSERT_FALSE(runs.empty());
    double sum = 0;
    for (std::size_t i = 0; i < runs.size(); ++i)
      sum += static_cast<double>(
          cost.at<float>(runs[i].first + runs[i].length, runs[(i + 1) % runs.size()].first));
    EXPECT_NEAR(sum, cheapest(cost, 14, 3, runs.front().first, runs.front().first, 0), 1e-5);
  }
}

TEST(Repeats, InTurnAreAllEntriesAgainAndAgain) {
  const cv::Mat cost = random_cost(16, 3);
  Repeats repeats(cost, {.min_run = 5, .in_turn = true});
  for (int i = 0; i < 5; ++i) {
    const auto run = repeats.next();
    EXPECT_EQ(run.start, 16 * i);
    EXPECT_EQ(run.first, 0);
    EXPECT_EQ(run.length, 16);
    if (i > 0) {
      EXPECT_EQ(repeats.jump(), static_cast<double>(cost.at<float>(16, 0)));
    }
  }
  EXPECT_EQ(cyclic(cost, 48, {.min_run = 5, .in_turn = true}).size(), 3u);
  EXPECT_TRUE(cyclic(cost, 47, {.min_run = 5, .in_turn = true}).empty());
}

}  // namespace
}  // namespace freshet::synth::flowlines
