#include "hints/stroke_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "freshet/error.h"
#include "tests/harness/fault.h"

namespace freshet::hints {
namespace {

const cv::Size kPicture(320, 240);

Stroke line(cv::Point2f from, cv::Point2f to, std::optional<float> speed = {}) { return {{from, to}, speed}; }

/// Degrees between a field's direction at a place and another.
double off(const StrokeField& field, cv::Point place, cv::Vec2f way) {
  const cv::Vec2f found = field.direction.at<cv::Vec2f>(place);
  return std::acos(std::clamp(found.dot(way) / (cv::norm(found) * cv::norm(way)), -1.0, 1.0)) * 180 / CV_PI;
}

std::vector<Stroke> two() { return {line({40, 200}, {60, 40}), line({160, 60}, {300, 100})}; }

TEST(StrokeField, OneStraightStrokeIsEverywhere) {
  const StrokeField field = interpolate({line({100, 100}, {140, 130})}, kPicture);
  ASSERT_EQ(field.direction.size(), kPicture);
  EXPECT_TRUE(field.speed.empty());
  for (int y = 0; y < kPicture.height; y += 7)
    for (int x = 0; x < kPicture.width; x += 7) {
      EXPECT_LT(off(field, {x, y}, {4, 3}), 0.1);
      EXPECT_NEAR(cv::norm(field.direction.at<cv::Vec2f>(y, x)), 1, 1e-5);
    }
}

TEST(StrokeField, GoesAsStrokesGoWhereTheyLie) {
  const StrokeField field = interpolate(two(), kPicture);
  for (const Stroke& stroke : two()) {
    const cv::Point2f way = stroke.points[1] - stroke.points[0];
    for (float t = 0.05f; t < 1; t += 0.1f)
      EXPECT_LT(off(field, stroke.points[0] + way * t, {way.x, way.y}), 3);
  }
  // A curve is followed too.
  Stroke arc;
  for (int i = 0; i <= 40; ++i)
    arc.points.emplace_back(160 + 90 * std::cos(i * 0.04f), 120 + 90 * std::sin(i * 0.04f));
  const StrokeField curved = interpolate({arc}, kPicture);
  for (int i = 4; i <= 36; i += 4)
    EXPECT_LT(off(curved, arc.points[i], {-std::sin(i * 0.04f), std::cos(i * 0.04f)}), 3);
}

TEST(StrokeField, BetweenStrokesTurnsEvenlyAndBeyondThemGoesOnAsTheNearest) {
  const StrokeField quarter =
      interpolate({line({40, 60}, {40, 180}), line({220, 120}, {300, 120})}, kPicture);
  EXPECT_LT(off(quarter, {140, 120}, {1, 1}), 20);
  EXPECT_LT(off(quarter, {2, 120}, {0, 1}), 12);
  EXPECT_LT(off(quarter, {317, 120}, {1, 0}), 12);
  double last = -1;
  for (int x = 40; x <= 220; x += 6) {
    const double turned = off(quarter, {x, 120}, {0, 1});
    EXPECT_GE(turned, last - 1);
    last = turned;
  }
}

TEST(StrokeField, TurnsWhenTheStrokesTurn) {
  // By a quarter, about the middle of a square picture: (x, y) goes to (240 - y, x).
  const cv::Size kSquare(240, 240);
  std::vector<Stroke> upright{line({40, 200}, {60, 40}), line({130, 60}, {220, 100})}, turned = upright;
  for (Stroke& stroke : turned)
    for (cv::Point2f& point : stroke.points) point = {240 - point.y, point.x};
  const StrokeField a = interpolate(upright, kSquare), b = interpolate(turned, kSquare);
  for (int y = 3; y < 240; y += 13)
    for (int x = 3; x < 240; x += 13) {
      const cv::Vec2f way = a.direction.at<cv::Vec2f>(y, x);
      EXPECT_LT(off(b, {239 - y, x}, {-way[1], way[0]}), 0.5);
    }
}

TEST(StrokeField, ACircleMakesAVortex) {
  Stroke circle;
  for (int i = 0; i <= 100; ++i) {
    const double angle = i * 2 * CV_PI / 100;
    circle.points.emplace_back(160 + 70 * std::cos(angle), 120 + 70 * std::sin(angle));
  }
  const StrokeField field = interpolate({circle}, kPicture);
  for (const double radius : {30.0, 70.0, 110.0})
    for (double angle = 0.1; angle < 6.2; angle += 0.3) {
      const cv::Point place(cvRound(160 + radius * std::cos(angle)), cvRound(120 + radius * std::sin(angle)));
      EXPECT_LT(off(field, place, cv::Vec2d(-std::sin(angle), std::cos(angle))), 6) << radius << " " << angle;
    }
}

TEST(StrokeField, SpeedsAreReachedAndNeverLeftBehind) {
  const StrokeField field = interpolate(
      {line({40, 60}, {40, 180}, 200), line({280, 60}, {280, 180}, 20), line({160, 60}, {160, 180})},
      kPicture);
  EXPECT_NEAR(field.speed.at<float>(120, 40), 200, 8);
  EXPECT_NEAR(field.speed.at<float>(120, 280), 20, 1);
  EXPECT_NEAR(std::log(field.speed.at<float>(120, 160)), (std::log(200) + std::log(20)) / 2, 0.1);
  double low = 0, high = 0;
  cv::minMaxLoc(field.speed, &low, &high);
  EXPECT_GE(low, 19.99);
  EXPECT_LE(high, 200.01);
}

TEST(StrokeField, GathersSpeedAlongAStroke) {
  Stroke falling = line({160, 20}, {160, 220});
  falling.speeds = {20, 60, 100};
  const StrokeField field = interpolate({falling}, kPicture);
  EXPECT_NEAR(field.speed.at<float>(70, 160), 40, 2);
  EXPECT_NEAR(field.speed.at<float>(120, 160), 60, 2);
  EXPECT_NEAR(field.speed.at<float>(170, 160), 80, 2);
}

std::string clash(const std::vector<Stroke>& strokes) { return interpolate(strokes, kPicture).clash; }

TEST(StrokeField, TellsOfStrokesThatContradictEachOther) {
  const std::string against =
      clash({line({10, 10}, {20, 10}), line({100, 50}, {100, 150}), line({104, 140}, {104, 90})});
  EXPECT_NE(against.find("stroke 2 and stroke 3 run against each other at (104, 1"), std::string::npos)
      << against;
  const std::string itself = clash({Stroke{{{50, 50}, {150, 50}, {50, 53}}}});
  EXPECT_NE(itself.find("stroke 1 runs against itself"), std::string::npos) << itself;
  EXPECT_EQ(clash({line({100, 50}, {100, 150}), line({130, 140}, {130, 90})}), "")
      << "30 px apart is a shear";
  EXPECT_EQ(clash({line({100, 50}, {100, 150}), line({50, 100}, {150, 100})}), "") << "they may cross";
}

TEST(StrokeField, OpposingStrokesKeepTheirOwnSides) {
  const StrokeField field = interpolate({line({150, 40}, {150, 200}), line({158, 200}, {158, 40})}, kPicture);
  for (int y = 60; y <= 180; y += 20) {
    EXPECT_LT(off(field, {120, y}, {0, 1}), 10) << y;
    EXPECT_LT(off(field, {188, y}, {0, -1}), 10) << y;
  }
}

TEST(StrokeField, OnAPlaneSpeedsShrinkTowardsItsHorizon) {
  const std::vector<Stroke> strokes{line({40, 200}, {280, 200}, 80)};
  const StrokeField field =
      interpolate(strokes, kPicture, "strokes", {.horizon = Horizon{{0, 40}, {320, 40}}});
  EXPECT_NEAR(field.speed.at<float>(200, 160), 80, 1);
  EXPECT_NEAR(field.speed.at<float>(120, 160), 40, 1);
  EXPECT_NEAR(field.speed.at<float>(41, 160), 0.75, 0.1);
  EXPECT_EQ(field.speed.at<float>(20, 160), 0);
  // Two strokes of one water: what is seen of it between them is that water, too.
  std::vector<Stroke> two = strokes;
  two.push_back(line({40, 80}, {280, 80}, 20));
  const StrokeField between = interpolate(two, kPicture, "strokes", {.horizon = Horizon{{0, 40}, {320, 40}}});
  EXPECT_NEAR(between.speed.at<float>(140, 160), 50, 2);
  // Towards the viewer as the square of the distance.
  const StrokeField coming = interpolate({line({160, 198}, {160, 202}, 80)}, kPicture, "strokes",
                                         {.horizon = Horizon{{0, 40}, {320, 40}}});
  EXPECT_NEAR(coming.speed.at<float>(120, 160), 20, 2);
}

TEST(StrokeField, TakesAnyNumberAndLengthOfStrokes) {
  std::vector<Stroke> many;
  for (int i = 0; i < 3000; ++i) {
    const float x = static_cast<float>(i % 60) * 5, y = static_cast<float>(i / 60) * 4.5f;
    many.push_back(line({x, y}, {x + 3, y + 1}));
  }
  EXPECT_LT(off(interpolate(many, kPicture), {160, 120}, {3, 1}), 0.5);
  Stroke far = line({-1e6f, 120}, {1e6f, 120});
  EXPECT_LT(off(interpolate({far}, kPicture), {160, 20}, {1, 0}), 0.5);
  EXPECT_LT(off(interpolate({line({5, 5}, {5, 5.6f})}, kPicture), {160, 20}, {0, 1}), 0.5) << "a dash";
  EXPECT_THROW(interpolate({}, kPicture), Error);
  EXPECT_THROW(interpolate({line({5000, 5000}, {5100, 5000})}, kPicture), Error);
}

TEST(StrokeField, IsTheSameInAPictureOfAnotherSize) {
  std::vector<Stroke> larger = two();
  for (Stroke& stroke : larger)
    for (cv::Point2f& point : stroke.points) point *= 3;
  const StrokeField a = interpolate(two(), kPicture), b = interpolate(larger, kPicture * 3);
  for (int y = 5; y < 240; y += 23)
    for (int x = 5; x < 320; x += 23) {
      const cv::Vec2f way = a.direction.at<cv::Vec2f>(y, x);
      EXPECT_LT(off(b, cv::Point(3 * x + 1, 3 * y + 1), way), 3);
    }
}

}  // namespace
}  // namespace freshet::hints
