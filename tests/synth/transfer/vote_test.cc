#include "synth/transfer/vote.h"

#include <gtest/gtest.h>

namespace freshet::synth::transfer {
namespace {

// Two overlapping patches in a row: columns 1 to 3 from the first, 2 to 4 from the second.
struct Overlap {
  PixelGrid source{12, 3}, into{6, 3, {{-1, -1, -1, -1}}};
  NearestField field{12, 3, 6, 3};

  Overlap(float first, float second) {
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 12; ++x) source(x, y).c[0] = static_cast<float>(10 * y + x);
    field.source[6 + 2] = 12 + 3;
    field.source[6 + 3] = 12 + 8;
    field.distance[6 + 2] = first;
    field.distance[6 + 3] = second;
  }
};

TEST(Vote, IsTheMeanOfWhatPatchesSayAndLeavesTheRest) {
  Overlap overlap(1, 5);
  vote(overlap.source, overlap.field, 3, 0, overlap.into);
  for (int y = 0; y < 3; ++y) {
    const float row = static_cast<float>(10 * y);
    EXPECT_EQ(overlap.into(0, y).c[0], -1);
    EXPECT_EQ(overlap.into(1, y).c[0], row + 2);
    EXPECT_EQ(overlap.into(2, y).c[0], row + 5);  // 3 and 7
    EXPECT_EQ(overlap.into(3, y).c[0], row + 6);
    EXPECT_EQ(overlap.into(4, y).c[0], row + 9);
    EXPECT_EQ(overlap.into(5, y).c[0], -1);
  }
}

TEST(Vote, NearerPatchesCountMore) {
  Overlap overlap(1, 16);
  vote(overlap.source, overlap.field, 3, 0.5, overlap.into);
  EXPECT_NEAR(overlap.into(2, 1).c[0], (4 * 13 + 17) / 5.0, 0.01);
}

}  // namespace
}  // namespace freshet::synth::transfer
