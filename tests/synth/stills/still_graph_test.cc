#include "synth/stills/still_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "synth/stills/partial_order.h"
#include "tests/synth/stills/made_stills.h"

namespace freshet::synth::stills {
namespace {

const std::vector<double> kPhases{.6, 0, .3, 1, .8, .15, .45};
const std::vector<int> kTrueOrder{1, 5, 2, 6, 0, 4, 3};

/// Shortest way by trying all of them.
double shortest(const StillGraph& graph, int from, int to, std::vector<char>& used) {
  if (from == to) return 0;
  double best = std::numeric_limits<double>::infinity();
  used[from] = 1;
  for (int next = 0; next < graph.count(); ++next)
    if (!used[next] && graph.edge(from, next) != 0)
      best = std::min(best, graph.weight(from, next) + shortest(graph, next, to, used));
  used[from] = 0;
  return best;
}

TEST(StillGraph, DistancesAreThoseOfTheShortestWays) {
  const StillGraph graph = make_graph(still_distances(made_pendulum(kPhases), {}));
  for (int i = 0; i < graph.count(); ++i)
    for (int j = 0; j < graph.count(); ++j) {
      std::vector<char> used(static_cast<std::size_t>(graph.count()), 0);
      const double truth = shortest(graph, i, j, used);
      EXPECT_NEAR(graph.distance(i, j), truth, 1e-9 * truth);
      double along = 0;
      const std::vector<int> way = graph.way(i, j);
      for (std::size_t k = 0; k + 1 < way.size(); ++k) along += graph.weight(way[k], way[k + 1]);
      EXPECT_NEAR(along, truth, 1e-9 * truth);
    }
}

TEST(StillGraph, APlainNormKnowsNoWayButTheDirectOne) {
  const Square<double> rms = still_distances(made_pendulum(kPhases), {}, .6);
  const StillGraph graph = make_graph(rms, {.power = 1, .cut_above = 100});
  for (int i = 0; i < graph.count(); ++i)
    for (int j = 0; j < graph.count(); ++j) EXPECT_EQ(graph.way(i, j).size(), i == j ? 1u : 2u);
}

TEST(StillGraph, LooksOnlyWhereTheMaskIs) {
  std::vector<cv::Mat> stills = made_pendulum({.5, .5});
  stills[1](cv::Rect(0, 0, 160, 8)).setTo(cv::Scalar::all(255));
  cv::Mat mask(stills[0].size(), CV_8U, cv::Scalar(255));
  EXPECT_GT(still_distances(stills, mask)(0, 1), 5);
  mask(cv::Rect(0, 0, 160, 10)).setTo(0);
  EXPECT_LT(still_distances(stills, mask)(0, 1), 1e-3);
}

TEST(StillGraph, FallsApartWhereEdgesAreCutAndIsJoinedByHand) {
  const Square<double> rms = still_distances(made_pendulum({0, .05, .95, 1}), {});
  GraphOptions options{.cut_above = 1};
  const StillGraph apart = make_graph(rms, options);
  EXPECT_EQ(apart.parts(), 2);
  EXPECT_TRUE(apart.way(0, 3).empty());
  options.join = {{1, 2}};
  const StillGraph joined = make_graph(rms, options);
  EXPECT_EQ(joined.parts(), 1);
  EXPECT_EQ(joined.way(0, 3), (std::vector<int>{0, 1, 2, 3}));
  options.cut = {{1, 2}};
  EXPECT_EQ(make_graph(rms, options).parts(), 2) << "what is cut is cut";
}

TEST(PartialOrder, FindsTheOrderOfAPendulum) {
  const std::vector<Path> paths = extremal_paths(make_graph(still_distances(made_pendulum(kPhases), {})));
  ASSERT_EQ(paths.size(), 2u);
  EXPECT_TRUE(std::find(paths.begin(), paths.end(), kTrueOrder) != paths.end());
  EXPECT_TRUE(std::find(paths.begin(), paths.end(), reversed(kTrueOrder)) != paths.end());
}

TEST(PartialOrder, LeavesOutWhatIsPartOfAnother) {
  const std::vector<Path> paths{{1, 2, 3}, {2, 3}, {3, 2}, {1, 3}, {1, 2, 3}};
  EXPECT_EQ(without_contained(paths), (std::vector<Path>{{1, 2, 3}, {3, 2}, {1, 3}}));
}

}  // namespace
}  // namespace freshet::synth::stills
