#include "synth/animate/clips/piece_standing.h"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "tests/synth/animate/flowing_clip.h"
#include "vision/detail_lifetime.h"

namespace freshet::synth::animate {
namespace {

using Bands = std::array<float, vision::kLifeBands>;

/// Cells of a clip of 150 x 110 px, left and right half apart.
vision::CellMap cells(const Bands& left, const Bands& right) {
  vision::CellMap made{
      .rows = 4, .columns = 5, .channels = vision::kStandingChannels, .cell = 32, .values = {}};
  for (int i = 0; i < 20; ++i) {
    const Bands& shares = i % 5 < 2 ? left : right;
    made.values.insert(made.values.end(), shares.begin(), shares.end());
  }
  return made;
}

Placement placed(const std::vector<store::ClipId>& clips, cv::Point patch = {8, 8}, float scale = 1) {
  Placement placement;
  for (const store::ClipId clip : clips)
    placement.patches.push_back({.piece = {}, .clip = clip, .variant = {.scale = scale}, .patch = patch});
  return placement;
}

TEST(PieceStanding, IsTheMeanOfThePatches) {
  const FlowingClip a{.frames = 9, .standing = cells({0.1f, 0.2f, 0.3f, 0.4f}, {1, 1, 1, 1})},
      b{.frames = 9, .standing = cells({0.3f, 0.4f, 0.5f, 0.6f}, {1, 1, 1, 1})}, older{.frames = 9};
  const FlowingStore store({a, b, older});
  const std::vector<double> shares =
      standing_shares(store.snapshot(), placed({store.id(0), store.id(1), store.id(2)}), 3);
  ASSERT_EQ(shares.size(), 4u);
  for (int level = 0; level < 4; ++level) EXPECT_NEAR(shares[level], 0.2 + 0.1 * level, 1e-6) << level;
}

TEST(PieceStanding, OfAReducedPatchIsThatOfTheCoarserBand) {
  const FlowingClip clip{.frames = 9, .standing = cells({0.1f, 0.2f, 0.4f, 0.8f}, {0.1f, 0.2f, 0.4f, 0.8f})};
  const FlowingStore store({clip});
  const std::vector<double> half = standing_shares(store.snapshot(), placed({store.id()}, {8, 2}, 0.5f), 2);
  EXPECT_NEAR(half[0], 0.2, 1e-6);
  EXPECT_NEAR(half[1], 0.4, 1e-6);
  EXPECT_NEAR(half[2], 0.8, 1e-6);
  // A picture whose pieces lie on it reduced by two shows the patches twice as large.
  Placement enlarged = placed({store.id()});
  enlarged.piece_scale = 2;
  const std::vector<double> twice = standing_shares(store.snapshot(), enlarged, 2);
  EXPECT_NEAR(twice[0], 0.1, 1e-6);
  EXPECT_NEAR(twice[1], 0.1, 1e-6);
  EXPECT_NEAR(twice[2], 0.2, 1e-6);
}

TEST(PieceStanding, GoesOnBeyondTheCoarsestBand) {
  const FlowingClip clip{.frames = 9, .standing = cells({0.1f, 0.1f, 0.2f, 0.5f}, {0.1f, 0.1f, 0.2f, 0.5f})};
  const FlowingStore store({clip});
  const std::vector<double> shares = standing_shares(store.snapshot(), placed({store.id()}), 5);
  // Odds of 1 / 4 and 1: then of 4 and 16.
  EXPECT_NEAR(shares[4], 0.8, 1e-6);
  EXPECT_NEAR(shares[5], 16 / 17.0, 1e-6);
}

TEST(PieceStanding, IsNoneInStoresThatSayNothing) {
  const FlowingClip older{.frames = 9};
  const FlowingStore store(std::vector{older});
  EXPECT_EQ(standing_shares(store.snapshot(), placed({store.id()}), 3), (std::vector<double>(4, 0.0)));
}

TEST(PieceStanding, ThatCannotBeIsRefused) {
  for (const float wrong : {-0.1f, 1.1f, std::nanf("")}) {
    const FlowingClip clip{.frames = 9, .standing = cells({0.1f, wrong, 0.2f, 0.5f}, {0, 0, 0, 0})};
    const FlowingStore store({clip});
    EXPECT_THROW(standing_shares(store.snapshot(), placed({store.id()}), 3), Error) << wrong;
  }
}

/// Cells of a clip of 150 x 110 px of which this much of the contrast stays, and this much goes.
vision::CellMap contrasts(float stays, float goes) {
  vision::CellMap made{
      .rows = 4, .columns = 5, .channels = vision::kLayoutChannels, .cell = 32, .values = {}};
  for (int i = 0; i < 20; ++i)
    for (int channel = 0; channel < vision::kLayoutChannels; ++channel)
      made.values.push_back(channel < vision::kLifeBands ? stays : goes);
  return made;
}

TEST(PieceLayout, StandsWhereThePatchesDo) {
  const FlowingClip fall{.frames = 9, .contrast = contrasts(0.8f, 0.6f)},
      sea{.frames = 9, .contrast = contrasts(0.05f, 0.7f)},
      between{.frames = 9, .contrast = contrasts(0.2f, 0.45f)}, older{.frames = 9};
  const FlowingStore store({fall, sea, between, older});
  Placement placement = placed({store.id(0), store.id(1), store.id(2), store.id(3)});
  for (int i = 0; i < 4; ++i) placement.patches[static_cast<std::size_t>(i)].piece.x = placement.stride * i;
  const std::vector<cv::Mat> shares = layout_shares(store.snapshot(), placement, 5);
  ASSERT_EQ(shares.size(), 5u);
  for (const cv::Mat& share : shares) {
    ASSERT_EQ(share.cols, 4);
    EXPECT_EQ(share.at<float>(0, 0), 1);
    EXPECT_EQ(share.at<float>(0, 1), 0);
    EXPECT_NEAR(share.at<float>(0, 2), 0.216, 0.02);
    EXPECT_EQ(share.at<float>(0, 3), 0);
  }
}

}  // namespace
}  // namespace freshet::synth::animate
