#include "synth/transfer/exemplar.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "tests/synth/transfer/made_exemplar.h"

namespace freshet::synth::transfer {
namespace {

constexpr int kRise = 3;  // px a frame

/// A wall of which the window sees another part at t = 0 and 1: what it shows rises.
ExemplarFrame rising(int t) {
  static const cv::Mat wall = blot({64, 80}, 3);
  const cv::Rect window(8, 12 + kRise * t, 40, 36);
  return {wall(window).clone(), cv::Mat(window.size(), CV_32FC2, cv::Scalar(0, kRise))};
}

/// Channels of two frames differ so much within the picture, at most.
int most_apart(const ExemplarLevel& level, int inset) {
  int most = 0;
  for (int y = inset; y < level.now.height - inset; ++y)
    for (int x = inset; x < level.now.width - inset; ++x)
      for (int c = 0; c < 4; ++c) {
        const std::int16_t* at =
            level.features.values.data() + static_cast<std::size_t>(y * level.now.width + x) * kChannels;
        most = std::max(most, std::abs(at[c] - at[6 + c]));
      }
  return most;
}

TEST(PreparedExemplar, OneThatIsStabilisedIsComparedWithWhereItCameFrom) {
  const ExemplarFrame now = rising(1);
  EXPECT_EQ(most_apart(prepare(now, rising(0), 1, {.stabilised = true}).levels.front(), kRise), 0);
  EXPECT_GT(most_apart(prepare(now, rising(0), 1, {}).levels.front(), kRise), 100);
}

TEST(PreparedExemplar, PlacesGoOnAsItsFluidDoesAlsoWhereItIsTurned) {
  ExemplarFrame frame = rising(1);
  frame.back.setTo(cv::Scalar(-2.4, 3.4));  // it goes right and up
  const PreparedExemplar exemplar = prepare(frame, rising(0), 1, {.stabilised = true, .quarter_turns = 4});
  const ExemplarLevel& finest = exemplar.levels.front();
  const auto place_of = [&](int x, int y, int turn) {
    GridOf<std::uint8_t> mark(frame.bgra.cols, frame.bgra.rows, 0);
    mark(x, y) = 1;
    const GridOf<std::uint8_t> turned = quarter_turned(mark, turn);
    for (int v = 0; v < turned.height; ++v)
      for (int u = 0; u < turned.width; ++u)
        if (turned(u, v)) return static_cast<std::int32_t>(finest.join({u, v, turn}));
    return std::int32_t{-1};
  };
  GridOf<std::int32_t> places(6, 1, -1);
  for (int turn = 0; turn < 4; ++turn) places(turn, 0) = place_of(10, 12, turn);
  places(4, 0) = place_of(39, 12, 0);
  follow(exemplar, places);
  for (int turn = 0; turn < 4; ++turn) EXPECT_EQ(places(turn, 0), place_of(12, 9, turn)) << turn;
  EXPECT_EQ(places(4, 0), -1) << "it leaves the picture";
  EXPECT_EQ(places(5, 0), -1);
}

TEST(PreparedExemplar, GuidesTurnWithIt) {
  const ExemplarFrame frame = rising(1);
  const ExemplarLevel level =
      prepare(frame, rising(0), 1, {.curvature = 1, .quarter_turns = 4}).levels.front();
  VectorGrid guides(level.now.width, level.now.height);
  guides.values = level.features.guides;
  double bent = 0;
  for (int y = 0; y < frame.bgra.rows; ++y)
    for (int x = 0; x < frame.bgra.cols; ++x) {
      const float here = guides(x, y).x;
      bent += static_cast<double>(std::abs(here));
      EXPECT_EQ(here, guides(y, frame.bgra.cols - 1 - x + level.block).x);
    }
  EXPECT_GT(bent, 100);
}

TEST(PreparedExemplar, RefusesAFlowOfAnotherSize) {
  ExemplarFrame frame = rising(1);
  frame.back = cv::Mat(8, 8, CV_32FC2, cv::Scalar::all(0));
  EXPECT_THROW(prepare(frame, rising(0), 1, {}), Error);
}

}  // namespace
}  // namespace freshet::synth::transfer
