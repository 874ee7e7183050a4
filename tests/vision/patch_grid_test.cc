#include "vision/patch_grid.h"

#include <gtest/gtest.h>

#include "freshet/error.h"

namespace freshet::vision {
namespace {

TEST(PatchGrid, HoldsEveryPatchThatLiesWhollyInside) {
  const auto positions = patch_positions({100, 72}, {.patch = 48, .stride = 24});
  const std::vector<cv::Point> expected{{0, 0}, {24, 0}, {48, 0}, {0, 24}, {24, 24}, {48, 24}};
  EXPECT_EQ(positions, expected);
  EXPECT_EQ(patch_positions({48, 48}, {}).size(), 1u);
  EXPECT_TRUE(patch_positions({47, 480}, {}).empty());
}

TEST(PatchGrid, MirroredGridIsTheMirrorImage) {
  for (const cv::Size frame : {cv::Size(100, 72), cv::Size(640, 360), cv::Size(131, 49)}) {
    const PatchGrid grid{.patch = 48, .stride = 24};
    const auto plain = patch_positions(frame, grid), mirrored = patch_positions(frame, grid, true);
    ASSERT_EQ(plain.size(), mirrored.size());
    const std::size_t columns = (frame.width - 48) / 24 + 1;
    for (std::size_t i = 0; i < plain.size(); ++i) {
      const std::size_t twin = i / columns * columns + (columns - 1 - i % columns);
      EXPECT_EQ(mirrored[twin], cv::Point(frame.width - 48 - plain[i].x, plain[i].y));
    }
  }
}

TEST(PatchGrid, CoverageIsTheShareOfSetPixels) {
  cv::Mat mask(60, 90, CV_8U);
  cv::randu(mask, 0, 3);  // zeros, ones and twos: any value but zero counts
  const auto positions = patch_positions(mask.size(), {.patch = 13, .stride = 7});
  const auto coverage = patch_coverage(mask, positions, 13);
  ASSERT_EQ(coverage.size(), positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const int count = cv::countNonZero(mask(cv::Rect(positions[i], cv::Size(13, 13))));
    EXPECT_FLOAT_EQ(coverage[i], count / 169.0f);
  }
  EXPECT_THROW(patch_coverage(mask, {{80, 0}}, 13), Error);
}

}  // namespace
}  // namespace freshet::vision
