#include "synth/animate/clips/piece_lives.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/synth/animate/flowing_clip.h"

namespace freshet::synth::animate {
namespace {

/// Cells of a clip of 150 x 110 px, left and right half apart: lives by band, each with the same contrast.
vision::CellMap cells(const std::array<float, 4>& left, const std::array<float, 4>& right,
                      const std::array<float, 4>& contrast) {
  vision::CellMap made{.rows = 4, .columns = 5, .channels = vision::kLifeChannels, .cell = 32, .values = {}};
  for (int i = 0; i < 20; ++i) {
    const auto& lives = i % 5 < 2 ? left : right;
    made.values.insert(made.values.end(), lives.begin(), lives.end());
    made.values.insert(made.values.end(), contrast.begin(), contrast.end());
  }
  return made;
}

PlacedPatch shown(store::ClipId clip, cv::Point patch = {}, double speed = 1) {
  return {.piece = {}, .clip = clip, .variant = {}, .patch = patch, .speed = speed};
}

Placement placed(const std::vector<PlacedPatch>& patches) {
  Placement placement;
  placement.patches = patches;
  return placement;
}

TEST(PieceLives, AreThePatchesOwnInSecondsOfTheAnimation) {
  const FlowingClip clip{.frames = 9,
                         .life = cells({0.1f, 0.2f, 0.4f, 0.8f}, {1, 2, 3, 4}, {0.01f, 0.01f, 0.01f, 0.01f})};
  const FlowingStore store({clip});
  const PieceLives lives =
      piece_lives(store.snapshot(), placed({shown(store.id(), {8, 8}), shown(store.id(), {100, 8}, 2)}));
  ASSERT_EQ(lives.half_life_s.size(), 2u);
  EXPECT_NEAR(lives.half_life_s[0][1], 0.2, 1e-6);
  EXPECT_NEAR(lives.half_life_s[1][1], 1, 1e-6);  // twice as fast, half as long
  EXPECT_NEAR(lives.power[1][3], 1e-4, 1e-8);
}

TEST(PieceLives, TogetherAreLedByTheDetailOfGreatestPowerAndNotByForms) {
  const FlowingClip clip{.frames = 9,
                         .life = cells({0.1f, 0.1f, 2, 6}, {0.1f, 0.1f, 2, 6}, {0.001f, 0.001f, 0.1f, 1})};
  const FlowingStore store({clip});
  const PieceLives lives = piece_lives(store.snapshot(), placed({shown(store.id(), {8, 8})}));
  EXPECT_NEAR(lives.overall_s, 2, 0.01);
  EXPECT_NEAR(lives.forms_s, 6, 0.01);
}

TEST(PieceLives, TogetherAreTheMiddlePieces) {
  const std::array<float, 4> even{0.01f, 0.01f, 0.01f, 0.01f};
  const FlowingClip brief{.frames = 9,
                          .life = cells({0.1f, 0.2f, 0.4f, 0.8f}, {0.1f, 0.2f, 0.4f, 0.8f}, even)},
      standing{.frames = 9, .life = cells({6, 6, 6, 6}, {6, 6, 6, 6}, even)};
  const FlowingStore store({brief, standing});
  const PieceLives lives =
      piece_lives(store.snapshot(), placed({shown(store.id(0)), shown(store.id(1)), shown(store.id(0))}));
  EXPECT_NEAR(lives.overall_s, 0.2, 1e-6);
}

TEST(PieceLives, TakeTheOthersWhereNothingIsKnown) {
  const FlowingClip known{.frames = 9, .life = cells({0.3f, 0, 0.4f, 0}, {0.3f, 0, 0.4f, 0}, {})},
      older{.frames = 9};
  const FlowingStore store({known, older});
  const PieceLives lives = piece_lives(store.snapshot(), placed({shown(store.id(0)), shown(store.id(1))}));
  const std::array expected{0.3, 0.3, 0.4, 0.4};
  for (const LifeBands& life : lives.half_life_s)
    for (int b = 0; b < 4; ++b) EXPECT_NEAR(life[b], expected[b], 1e-6) << b;
}

TEST(PieceLives, AreASecondInStoresThatSayNothing) {
  const FlowingClip older{.frames = 9};
  const FlowingStore store(std::vector{older});
  const PieceLives lives = piece_lives(store.snapshot(), placed({shown(store.id())}));
  EXPECT_EQ(lives.half_life_s, (std::vector<LifeBands>{{1, 1, 1, 1}}));
  EXPECT_EQ(lives.overall_s, 1);
}

}  // namespace
}  // namespace freshet::synth::animate
