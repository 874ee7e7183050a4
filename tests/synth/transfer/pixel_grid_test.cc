#include "synth/transfer/pixel_grid.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "synth/transfer/segments.h"
#include "tests/synth/transfer/made_exemplar.h"

namespace freshet::synth::transfer {
namespace {

TEST(TransferPicture, StraightAndPremultipliedAreInverse) {
  const cv::Mat picture = blot({40, 30}, 1);
  cv::Mat back;
  straight(premultiplied(picture)).convertTo(back, CV_8U, 255);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      const cv::Vec4b in = picture.at<cv::Vec4b>(y, x), out = back.at<cv::Vec4b>(y, x);
      ASSERT_EQ(out, in[3] == 0 ? cv::Vec4b(0, 0, 0, 0) : in);  // the colour of nothing is nothing
    }
}

TEST(TransferPicture, AQuarterTurnIsAnticlockwiseAndFourAreNone) {
  Grid grid(3, 2);
  for (int i = 0; i < 6; ++i) grid.values[static_cast<std::size_t>(i)] = static_cast<float>(i);
  const Grid turned = quarter_turned(grid, 1);
  ASSERT_EQ(turned.width, 2);
  EXPECT_EQ(turned.values, (std::vector<float>{2, 5, 1, 4, 0, 3}));
  EXPECT_EQ(quarter_turned(quarter_turned(grid, 2), 2).values, grid.values);
}

TEST(TransferPicture, BlurKeepsSumsAndWidens) {
  Grid grid(41, 41);
  grid(20, 20) = 1;
  const Grid out = blurred(grid, 3);
  double sum = 0, square = 0;
  for (int y = 0; y < 41; ++y)
    for (int x = 0; x < 41; ++x) {
      sum += static_cast<double>(out(x, y));
      square += static_cast<double>(out(x, y)) * (x - 20) * (x - 20);
    }
  EXPECT_NEAR(sum, 1, 1e-5);
  EXPECT_NEAR(square, 9, 0.3);  // less, by what is cut at 3 sigma
}

TEST(TransferSegments, FollowTheThresholdsAndKeepTheMargin) {
  Grid alpha(40, 40);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) alpha(x, y) = (static_cast<float>(x) + 0.5f) / 40;
  Segments out;
  segment(alpha, 0.1, 0.9, 2, out);
  EXPECT_EQ(out.of(3, 20), Segment::kNone);
  EXPECT_EQ(out.of(4, 20), Segment::kBoundary);
  EXPECT_EQ(out.of(35, 20), Segment::kBoundary);
  EXPECT_EQ(out.of(36, 20), Segment::kInterior);
  EXPECT_EQ(out.of(38, 20), Segment::kNone);
  EXPECT_EQ(out.of(20, 1), Segment::kNone);
  EXPECT_EQ(out[Segment::kBoundary].size(), 32u * 36);
  EXPECT_EQ(out[Segment::kInterior].size(), 2u * 36);
  // Tiles are not torn apart.
  const std::vector<int>& list = out[Segment::kBoundary];
  for (std::size_t i = 1; i < list.size(); ++i) ASSERT_LE(tile_of(list[i - 1], 40), tile_of(list[i], 40));
}

Grid disc(double radius) {
  Grid alpha(96, 96);
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x)
      alpha(x, y) = static_cast<float>(std::clamp(radius - std::hypot(x - 47.5, y - 47.5) + 0.5, 0.0, 1.0));
  return alpha;
}

TEST(TransferPicture, CurvatureIsThatOfTheOutline) {
  for (const double radius : {12.0, 24.0}) {
    Grid alpha = blurred(disc(radius), 4);
    const auto at_rim = static_cast<int>(47.5 + radius);
    EXPECT_NEAR(curvature(alpha, 4)(at_rim, 47), 4 / radius, 0.06);
    for (float& value : alpha.values) value = 1 - value;
    EXPECT_NEAR(curvature(alpha, 4)(at_rim, 47), -4 / radius, 0.06) << "a hole bends the other way";
    EXPECT_NEAR(curvature(alpha, 4)(2, 2), 0, 1e-3) << "where there is no outline";
  }
}

TEST(TransferPicture, DivergenceIsTheGrowthOfArea) {
  VectorGrid flow(64, 48);
  Grid alpha(64, 48);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      alpha(x, y) = x < 48;
      flow(x, y) =
          x < 48 ? Vec2{0.03f * static_cast<float>(x), -0.01f * static_cast<float>(y)} : Vec2{90, 90};
    }
  EXPECT_NEAR(divergence(flow, alpha, 2)(24, 24), 5 * 0.02, 1e-3);
  EXPECT_NEAR(divergence(flow, alpha, 2)(45, 24), 5 * 0.02, 0.1) << "beside what is no fluid";
}

}  // namespace
}  // namespace freshet::synth::transfer
