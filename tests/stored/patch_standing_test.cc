#include "stored/patch_standing.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace freshet::stored {
namespace {

const cv::Size kSource(320, 192);

/// Cells of the source, columns before `from` with one share and the others with another.
vision::CellMap made_cells(const std::array<float, 4>& left, const std::array<float, 4>& right, int from) {
  vision::CellMap cells{
      .rows = 6, .columns = 10, .channels = vision::kStandingChannels, .cell = 32, .values = {}};
  for (int i = 0; i < 60; ++i) {
    const std::array<float, 4>& shares = i % 10 < from ? left : right;
    cells.values.insert(cells.values.end(), shares.begin(), shares.end());
  }
  return cells;
}

std::array<double, 4> standing_of(const vision::CellMap& cells, const vision::Variant& variant,
                                  cv::Point patch) {
  return patch_standing(cells, vision::variant_frame(kSource, variant), variant.scale, patch, 48);
}

TEST(PatchStanding, IsTheMeanOverThePatch) {
  // 32 px of column 2 and 16 of column 3.
  const vision::CellMap cells = made_cells({0, 0.1f, 0.2f, 0.3f}, {0.3f, 0.4f, 0.5f, 0.6f}, 3);
  const std::array<double, 4> standing = standing_of(cells, {}, {64, 60});
  for (int b = 0; b < 4; ++b) EXPECT_NEAR(standing[b], 0.1 * b + 0.1, 1e-6) << b;
}

TEST(PatchStanding, LiesWhereItsVariantShowsTheSource) {
  const vision::CellMap cells = made_cells({0, 0, 0, 0}, {1, 1, 1, 1}, 5);
  EXPECT_EQ(standing_of(cells, {}, {0, 0})[1], 0);
  EXPECT_NEAR(standing_of(cells, {.flip = true}, {0, 0})[1], 1, 1e-6);
  EXPECT_NEAR(standing_of(cells, {.scale = 0.5f}, {96, 0})[1], 1, 1e-6);
}

TEST(PatchStanding, BandsOfAScaledPatchAreCoarserOnesOfTheSource) {
  const std::array<float, 4> shares{0.1f, 0.2f, 0.4f, 0.9f};
  const vision::CellMap cells = made_cells(shares, shares, 5);
  const std::array<double, 4> half = standing_of(cells, {.scale = 0.5f}, {0, 0}),
                              between = standing_of(cells, {.scale = std::sqrt(0.5f)}, {0, 0}),
                              twice = standing_of(cells, {.scale = 2}, {0, 0});
  const std::array shifted{0.2, 0.4, 0.9, 0.9}, mixed{0.15, 0.3, 0.65, 0.9}, finer{0.1, 0.1, 0.2, 0.4};
  for (int b = 0; b < 4; ++b) {
    EXPECT_NEAR(half[b], shifted[b], 1e-6) << b;
    EXPECT_NEAR(between[b], mixed[b], 1e-5) << b;
    EXPECT_NEAR(twice[b], finer[b], 1e-6) << b;
  }
}

TEST(PatchLayout, IsWhatStaysAndDoesNotGoAlong) {
  vision::CellMap cells{
      .rows = 6, .columns = 10, .channels = vision::kLayoutChannels, .cell = 32, .values = {}};
  for (int i = 0; i < 60; ++i)  // a fall, a sea, neither, both
    cells.values.insert(cells.values.end(), {0.8f, 0, 0, 0.4f, 0, 0.8f, 0, 0.4f});
  const std::array<double, 4> found =
      patch_layout(cells, vision::variant_frame(kSource, {}), 1, {64, 60}, 48);
  const std::array wanted{0.8, 0.0, 0.0, 0.24};
  for (int b = 0; b < 4; ++b) EXPECT_NEAR(found[b], wanted[b], 1e-6) << b;
}

}  // namespace
}  // namespace freshet::stored
