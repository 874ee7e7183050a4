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

}  // namespace
}  // namespace freshet::synth::stills
