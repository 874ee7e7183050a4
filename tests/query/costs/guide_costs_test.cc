#include "query/costs/guide_costs.h"

#include <gtest/gtest.h>

namespace freshet::query {
namespace {

TEST(GuideCosts, ArePaidForNotMovingAsAsked) {
  const stored::PatchTable table{.clips = {},
                                 .first_row = {},
                                 .clip = {0, 0, 0},
                                 .variant = {},
                                 .x = {},
                                 .y = {},
                                 .mean_u = {10, 0, 40},
                                 .mean_v = {0, 10, 0},
                                 .coverage = {},
                                 .words = {}};
  Candidates candidates;
  candidates.k = 3;
  candidates.rows = {0, 1, 2};
  candidates.scores = {1, 1, 1};
  candidates.counts = {3};
  candidates.asked.push_back({.direction = cv::Vec2f(1, 0), .speed = 20});
  candidates.opened = {0};
  Mrf mrf;
  mrf.add_node(std::vector<float>{0, 0, 0});
  add_guide_costs(table, candidates, {.direction = 2, .speed = 0.5, .unsteady = 0}, mrf);
  EXPECT_NEAR(mrf.unary[0], 0.5, 1e-6);      // half the speed
  EXPECT_NEAR(mrf.unary[1], 2 + 0.5, 1e-6);  // and a right angle
  EXPECT_NEAR(mrf.unary[2], 0.5, 1e-6);      // twice the speed
  candidates.steadiness = {1, 0.25, 0};
  mrf.unary = {0, 0, 0};
  add_guide_costs(table, candidates, {.direction = 0, .speed = 0, .unsteady = 2}, mrf);
  EXPECT_EQ(mrf.unary, (std::vector<float>{0, 1.5, 2}));
  candidates.asked[0].direction = {0, 0};
  add_guide_costs(table, candidates, {.direction = 0, .speed = 0, .unsteady = 2}, mrf);
  EXPECT_EQ(mrf.unary, (std::vector<float>{0, 1.5, 2})) << "nobody asked where to";
}

}  // namespace
}  // namespace freshet::query
