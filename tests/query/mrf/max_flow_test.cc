#include "query/mrf/max_flow.h"

#include <gtest/gtest.h>

#include <random>

namespace freshet::query {
namespace {

TEST(MaxFlow, FindsTheSmallestOfAllCuts) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> capacity(0, 1);
  MaxFlow flow;
  for (int round = 0; round < 100; ++round) {
    constexpr std::uint32_t kNodes = 8;
    struct Arc {
      std::uint32_t from, to;
      double forth, back;
    };
    std::vector<Arc> arcs;
    std::vector<double> source(kNodes), sink(kNodes);
    flow.clear(kNodes);
    for (std::uint32_t node = 0; node < kNodes; ++node) {
      source[node] = random() % 2 ? capacity(random) : 0;
      sink[node] = random() % 2 ? capacity(random) : 0;
      flow.add_terminal(node, source[node], sink[node]);
      for (std::uint32_t other = 0; other < node; ++other) {
        if (random() % 3 == 0)
          arcs.push_back({other, node, capacity(random), capacity(random) - 0.5 > 0 ? 0.3 : 0});
      }
    }
    for (const Arc& arc : arcs) flow.add_edge(arc.from, arc.to, arc.forth, arc.back);
    const auto cut = [&](auto&& on_source_side) {
      double sum = 0;
      for (std::uint32_t node = 0; node < kNodes; ++node)
        sum += on_source_side(node) ? sink[node] : source[node];
      for (const Arc& arc : arcs) {
        if (on_source_side(arc.from) && !on_source_side(arc.to)) sum += arc.forth;
        if (!on_source_side(arc.from) && on_source_side(arc.to)) sum += arc.back;
      }
      return sum;
    };
    double minimum = 1e9;
    for (std::uint32_t side = 0; side < 1u << kNodes; ++side) {
      minimum = std::min(minimum, cut([&](std::uint32_t node) { return (side >> node & 1) != 0; }));
    }
    EXPECT_NEAR(flow.solve(), minimum, 1e-9);
    EXPECT_NEAR(cut([&](std::uint32_t node) { return flow.on_source_side(node); }), minimum, 1e-9);
  }
}

}  // namespace
}  // namespace freshet::query
