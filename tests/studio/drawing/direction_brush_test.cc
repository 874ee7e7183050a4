#include "studio/drawing/direction_brush.h"

#include <gtest/gtest.h>

namespace freshet::studio {
namespace {

const cv::Size kPicture(200, 160);

Drawn band(std::vector<cv::Point2f> points, float width, bool adds = true) {
  return {.points = std::move(points), .width = width, .adds = adds, .is_area = false};
}

TEST(DirectionBrush, LinesLieAcrossItsBandAndGoAlongIt) {
  const std::vector<DrawnStroke> lines = brush_strokes({band({{30, 50}, {150, 50}}, 40)}, kPicture);
  ASSERT_EQ(lines.size(), 5u);
  for (const DrawnStroke& line : lines) {
    EXPECT_FALSE(line.speed);
    EXPECT_NEAR(line.points.front().x, 30, 0.01);
    EXPECT_NEAR(line.points.back().x, 150, 0.01);
    for (const cv::Point2f& point : line.points) {
      EXPECT_LE(std::abs(point.y - 50), 16.01);
      EXPECT_NEAR(point.y, line.points[0].y, 0.01);
    }
  }
}

TEST(DirectionBrush, NoLineGoesBackWhereItTurns) {
  const std::vector<Drawn> brush{band({{20, 80}, {100, 80}, {100, 10}}, 60)};
  for (const DrawnStroke& line : brush_strokes(brush, kPicture))
    for (std::size_t i = 1; i < line.points.size(); ++i) {
      const cv::Point2f step = line.points[i] - line.points[i - 1];
      EXPECT_GT(step.x - step.y, 0);  // to the right, then up
    }
}

TEST(DirectionBrush, ALaterBandLiesOverEarlierOnes) {
  const std::vector<Drawn> brush{band({{30, 50}, {150, 50}}, 40), band({{90, 10}, {90, 100}}, 30)};
  std::size_t down = 0, along = 0;
  for (const DrawnStroke& line : brush_strokes(brush, kPicture)) {
    const cv::Point2f way = line.points.back() - line.points.front();
    if (way.y > std::abs(way.x)) {
      ++down;
      continue;
    }
    ++along;
    for (const cv::Point2f& point : line.points) EXPECT_GT(std::abs(point.x - 90), 13);
  }
  EXPECT_EQ(down, 5u);
  EXPECT_EQ(along, 10u) << "five on each side";
}

TEST(DirectionBrush, TakesAwayAndLeavesWhatLiesOutside) {
  EXPECT_TRUE(
      brush_strokes({band({{30, 50}, {150, 50}}, 40), band({{20, 50}, {160, 50}}, 60, false)}, kPicture)
          .empty());
  EXPECT_TRUE(brush_strokes({band({{-90, -50}, {-20, -50}}, 40)}, kPicture).empty());
  EXPECT_TRUE(brush_strokes({band({{50, 50}}, 40)}, kPicture).empty()) << "a dot goes nowhere";
  for (const DrawnStroke& line : brush_strokes({band({{-50, 100}, {400, 100}}, 10)}, kPicture))
    for (const cv::Point2f& point : line.points)
      EXPECT_TRUE(point.x >= 0 && point.x < kPicture.width) << point.x;
}

}  // namespace
}  // namespace freshet::studio
