#include "synth/flowlines/jumps/seam.h"

#include <gtest/gtest.h>

#include <cmath>

#include "query/mrf/max_flow.h"

namespace freshet::synth::flowlines {
namespace {

Meeting noise(cv::Size size, int labels, std::uint64_t seed) {
  Meeting meeting{.size = size, .labels = labels, .difference = {}};
  cv::RNG random(seed);
  for (int i = 0; i < size.area() * (labels + 1); ++i)
    meeting.difference.push_back(random.uniform(0.f, 40.f));
  return meeting;
}

/// The cost of some places alone, of which `labels` says how they go over.
double cost_of(const Meeting& meeting, const std::vector<int>& places, const std::vector<int>& labels) {
  Meeting part{.size = {static_cast<int>(places.size()), 1}, .labels = meeting.labels, .difference = {}};
  cv::Mat shown(part.size, CV_8U);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const float* of = meeting.of(places[i]);
    part.difference.insert(part.difference.end(), of, of + meeting.labels + 1);
    shown.data[i] = static_cast<std::uint8_t>(labels[i]);
  }
  return flowlines::cost_of(part, shown);
}

/// The smallest cost, by a maximum flow: node (place, k) is on the source's side when its label is above k.
double smallest(const Meeting& meeting) {
  const int nodes = meeting.labels - 1, width = meeting.size.width;
  query::MaxFlow flow;
  flow.clear(static_cast<std::uint32_t>(meeting.size.area() * nodes));
  const auto node = [&](int place, int k) { return static_cast<std::uint32_t>(place * nodes + k); };
  for (int place = 0; place < meeting.size.area(); ++place) {
    flow.add_terminal(node(place, 0), cost_of(meeting, {place}, {0}), 0);
    flow.add_terminal(node(place, nodes - 1), 0, cost_of(meeting, {place}, {nodes}));
    for (int k = 1; k < nodes; ++k)
      flow.add_edge(node(place, k - 1), node(place, k), cost_of(meeting, {place}, {k}), 1e9);
    for (const int other : {place % width > 0 ? place - 1 : -1, place - width})
      for (int k = 0; other >= 0 && k < nodes; ++k) {
        const double beside = cost_of(meeting, {place, other}, {k, k + 1}) - cost_of(meeting, {place}, {k}) -
                              cost_of(meeting, {other}, {k + 1});
        flow.add_edge(node(place, k), node(other, k), beside, beside);
      }
  }
  return flow.solve();
}

TEST(Seam, OfOneLineIsTheSmallestCut) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Meeting row = noise({16, 1}, 7, seed);
    EXPECT_NEAR(flowlines::cost_of(row, cut(row)), smallest(row), 1e-2) << seed;
  }
}

TEST(Seam, OfAPictureIsNearTheSmallestCut) {
  double ours = 0, least = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Meeting meeting = noise({9, 7}, 7, seed);
    const double cost = flowlines::cost_of(meeting, cut(meeting)), exact = smallest(meeting);
    EXPECT_GE(cost, exact - 1e-2) << seed;
    ours += cost;
    least += exact;
  }
  EXPECT_LT(ours, 1.05 * least);
}

TEST(Seam, GoesOverWhereTheRunsAreAlike) {
  Meeting meeting = noise({20, 14}, 9, 3);
  const auto alike = [](int x, int y) { return 1 + (x / 4 + y / 5) % 7; };
  for (int y = 0; y < 14; ++y)
    for (int x = 0; x < 20; ++x)
      for (int d = 0; d <= 9; ++d)
        meeting.difference[static_cast<std::size_t>((y * 20 + x) * 10 + d)] =
            std::abs(d - alike(x, y) - 0.5f) < 1.6f ? 0.f : 30.f;
  EXPECT_NEAR(flowlines::cost_of(meeting, cut(meeting)), 0, 1e-3);
}

TEST(Seam, IsMeasuredAlongTheParticles) {
  // Frame t is grey level t: two runs that are 7 frames apart differ by 7 in each channel, wherever the front is.
  std::vector<cv::Mat> frames;
  for (int t = 0; t < 40; ++t) frames.emplace_back(6, 8, CV_8UC3, cv::Scalar::all(t));
  cv::Mat arrival(4, 5, CV_32F);
  cv::randu(arrival, 0, 9);
  const Meeting meeting = meeting_of(frames, {2, 1}, arrival, 8, 15, 3);
  for (const float apart : meeting.difference) EXPECT_NEAR(apart, 7 * std::sqrt(3.0), 1e-3);
}

}  // namespace
}  // namespace freshet::synth::flowlines
