#include "synth/flowlines/streamlines.h"

#include <gtest/gtest.h>

#include <cmath>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::flowlines {
namespace {

/// Round a middle, clockwise as seen: lines would be closed.
cv::Mat swirl(cv::Size size) {
  cv::Mat field(size, CV_32FC2);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      field.at<cv::Vec2f>(y, x) =
          cv::Vec2f(static_cast<float>(size.height / 2 - y), static_cast<float>(x - size.width / 2));
  return field;
}

TEST(FlowLine, GoesOnStraightBeyondItsEnds) {
  const FlowLine line = evenly({{10, 10}, {10, 40}, {30, 60}});
  EXPECT_EQ(tangent(line, line.samples() + 50), tangent(line, line.samples() - 1));
  EXPECT_EQ(tangent(line, -50), cv::Point2f(0, 1));
  EXPECT_LT(cv::norm(at(line, -5) - cv::Point2f(10, 5)), 1e-4);
}

TEST(Streamlines, LieEvenlyInsideTheMatteAlongTheField) {
  const cv::Mat field(120, 160, CV_32FC2, cv::Scalar(1, 2));
  cv::Mat matte(field.size(), CV_8U, cv::Scalar(0));
  cv::rectangle(matte, cv::Rect(20, 10, 120, 100), cv::Scalar(255), cv::FILLED);
  const std::vector<FlowLine> lines = evenly_spaced(field, matte, {.spacing_px = 12, .min_length_px = 24});
  ASSERT_GT(lines.size(), 5u);
  for (const FlowLine& line : lines) {
    EXPECT_GE(line.length(), 24);
    for (int s = 0; s < line.samples(); ++s) {
      const cv::Point at(cvRound(line.points[static_cast<std::size_t>(s)].x),
                         cvRound(line.points[static_cast<std::size_t>(s)].y));
      EXPECT_EQ(matte.at<std::uint8_t>(at), 255);
      EXPECT_GT(tangent(line, s).dot(cv::Point2f(1, 2) * (1 / std::sqrt(5.0f))), 0.99f);
    }
  }
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (const cv::Point2f& a : lines[i].points)
        for (const cv::Point2f& b : lines[j].points) ASSERT_GT(cv::norm(a - b), 5.0) << i << " and " << j;
  // Nowhere in the matte is a line further than a spacing and a half.
  for (int y = 30; y < 90; y += 10)
    for (int x = 50; x < 110; x += 10) {
      double nearest = 1e9;
      for (const FlowLine& line : lines)
        for (const cv::Point2f& p : line.points)
          nearest = std::min(nearest, std::hypot(static_cast<double>(p.x) - x, static_cast<double>(p.y) - y));
      EXPECT_LT(nearest, 18);
    }
}

TEST(Streamlines, EndWhereTheyComeBackToThemselves) {
  const cv::Mat field = swirl({120, 120}), matte(120, 120, CV_8U, cv::Scalar(255));
  for (const FlowLine& line : evenly_spaced(field, matte, {.spacing_px = 12}))
    EXPECT_LT(line.length(), 2 * 380);
}

TEST(Streamlines, ThereAreNoneWhereNothingFlows) {
  const cv::Mat field(64, 64, CV_32FC2, cv::Scalar(0, 1));
  EXPECT_TRUE(evenly_spaced(field, cv::Mat(64, 64, CV_8U, cv::Scalar(0))).empty());
}

}  // namespace
}  // namespace freshet::synth::flowlines
