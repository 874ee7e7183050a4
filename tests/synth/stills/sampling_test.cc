#include "synth/stills/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "freshet/error.h"
#include "synth/stills/timeline.h"
#include "tests/synth/stills/made_stills.h"

namespace freshet::synth::stills {
namespace {

struct Pendulum {
  Square<double> rms = still_distances(made_pendulum({0, .2, .4, .6, .8, 1}), {});
  StillGraph graph = make_graph(rms);
  std::vector<Path> paths = extremal_paths(graph);
};

TEST(Sampling, APendulumSwingsFromEndToEnd) {
  const Pendulum p;
  const std::vector<int> walk =
      sample_sequence(p.graph, p.paths, {.steps = 60, .sigma = .02, .irregularity = 0});
  ASSERT_EQ(walk.size(), 61u);
  int turns_inside = 0;
  for (std::size_t k = 1; k + 1 < walk.size(); ++k) {
    EXPECT_EQ(std::abs(walk[k] - walk[k + 1]), 1) << "only neighbours follow each other";
    turns_inside += walk[k - 1] == walk[k + 1] && walk[k] != 0 && walk[k] != 5;
  }
  EXPECT_LE(turns_inside, 3);
  EXPECT_TRUE(std::count(walk.begin(), walk.end(), 0) > 2 && std::count(walk.begin(), walk.end(), 5) > 2);
}

TEST(Sampling, IrregularityAllowsTurnsWithinAPath) {
  const Pendulum p;
  const auto turns = [&](double irregularity) {
    const std::vector<int> walk =
        sample_sequence(p.graph, p.paths, {.steps = 300, .sigma = .5, .irregularity = irregularity});
    int count = 0;
    for (std::size_t k = 1; k + 1 < walk.size(); ++k)
      count += walk[k - 1] == walk[k + 1] && walk[k] != 0 && walk[k] != 5;
    return count;
  };
  EXPECT_GT(turns(1), 2 * turns(0));
}

TEST(Sampling, ALoopEndsWhereItBegan) {
  const Pendulum p;
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    const std::vector<int> walk =
        sample_sequence(p.graph, p.paths, {.steps = 17, .loop = true, .seed = seed});
    EXPECT_EQ(walk.front(), walk.back());
    EXPECT_NEAR(static_cast<double>(walk.size()), 18, 4);
    for (std::size_t k = 0; k + 1 < walk.size(); ++k) EXPECT_NE(walk[k], walk[k + 1]);
  }
}

TEST(Sampling, TheSameSeedGivesTheSameSequence) {
  const Pendulum p;
  const auto walk = [&](std::uint64_t seed) {
    return sample_sequence(p.graph, p.paths, {.steps = 40, .sigma = 1, .seed = seed});
  };
  EXPECT_EQ(walk(3), walk(3));
  EXPECT_NE(walk(3), walk(4));
}

TEST(Sampling, DeadEndsAreLeftOutWhereACircleIsLeft) {
  const std::vector<Path> paths{{0, 1, 2, 3}, {2, 3, 4, 1}, {1, 5, 6}};
  EXPECT_EQ(without_dead_ends(paths, 7), (std::vector<Path>{{1, 2, 3}, {2, 3, 4, 1}}));
  EXPECT_EQ(without_dead_ends({{0, 1, 2}}, 3), (std::vector<Path>{{0, 1, 2}}))
      << "nothing else would be left";
}

TEST(Sampling, SaysWhenNoPathIsLeft) {
  const Pendulum p;
  EXPECT_THROW(sample_sequence(p.graph, {}), Error);
}

TEST(Timeline, GoesThroughItsStillsInTimeAndRestsAtTurns) {
  const Pendulum p;
  const Timeline timeline({0, 1, 2, 1, 0}, p.rms, {.step_s = 1});
  EXPECT_EQ(timeline.at(0).from, 0);
  EXPECT_NEAR(timeline.seconds(), 4, 1.5);
  const double turn = timeline.times()[2];
  const Instant before = timeline.at(turn - .02), far_before = timeline.at(turn - .5);
  EXPECT_EQ(before.to, 2);
  EXPECT_GT(before.phase, .995) << "it slows down";
  EXPECT_LT(far_before.phase, .8);
  EXPECT_EQ(timeline.at(100).from, 0);
}

TEST(Timeline, ALoopTakesExactlyItsTime) {
  const Pendulum p;
  const Timeline timeline({0, 1, 2, 1, 0}, p.rms, {.step_s = .3, .exactly_s = 8});
  EXPECT_NEAR(timeline.seconds(), 8, 1e-9);
}

/// Stills of which each is as far from another as they are apart in a row; only neighbours are joined.
StillGraph row_of(int n) {
  Square<double> rms(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) rms(i, j) = std::abs(i - j);
  return make_graph(rms, {.power = 1, .cut_above = 0.75});
}

/// How often, of walks that come from 1 to 2, the next step goes on to 3.
double goes_on(const StillGraph& graph, SamplingOptions options) {
  const std::vector<Path> paths{{0, 1, 2, 3, 4}, {4, 3, 2, 1, 0}};
  options.steps = 2;
  options.irregularity = 1;  // no turn is taken back: the chain's own law
  int all = 0, on = 0;
  for (options.seed = 1; options.seed <= 60000; ++options.seed) {
    const std::vector<int> walk = sample_sequence(graph, paths, options);
    if (walk[0] != 1 || walk[1] != 2) continue;
    ++all;
    on += walk[2] == 3;
  }
  EXPECT_GT(all, 5000);
  return on / static_cast<double>(all);
}

TEST(Sampling, AStepOfTheSecondOrderGoesOnAndOneOfTheFirstDoesNotKnowWhereto) {
  const StillGraph graph = row_of(5);
  // Places (before, at -> after) of both paths, and their distances from (1, 2), Eq. 1:
  //   on: (1, 2 -> 3) 0, (2, 3 -> 4) 2, (3, 4 -> 3) 4; back: (1, 0 -> 1) 2, (3, 2 -> 1) 2, (2, 1 -> 0) 2; mean 2
  const auto share = [](std::initializer_list<double> on, std::initializer_list<double> back, double scale) {
    double forth = 0, all = 0;
    for (const double penalty : on) forth += std::exp(-penalty / scale);
    for (const double penalty : back) all += std::exp(-penalty / scale);
    return forth / (forth + all);
  };
  const double second = share({0, 2, 4}, {2, 2, 2}, 0.3 * 2), printed = share({0, 2, 4}, {2, 2, 2}, 0.3 * 12),
               first = share({0, 1, 2}, {2, 0, 1}, 0.3 * 1);
  EXPECT_NEAR(goes_on(graph, {.sigma = 0.3}), second, 0.015);
  EXPECT_NEAR(goes_on(graph, {.sigma = 0.3, .by_sum = true}), printed, 0.015) << "Eq. 2 as printed";
  EXPECT_NEAR(goes_on(graph, {.sigma = 0.3, .order = 1}), first, 0.015);
  EXPECT_GT(second, 0.85);
  EXPECT_LT(first, 0.55);
}

}  // namespace
}  // namespace freshet::synth::stills
