#include "vision/look/horizon.h"

#include <gtest/gtest.h>

#include <cmath>

namespace freshet::vision {
namespace {

const cv::Size kPicture(320, 240);

/// Fluid below a line, but for an island.
cv::Mat sea(float left, float right, int island = 0) {
  cv::Mat matte = cv::Mat::zeros(kPicture, CV_8U);
  for (int x = 0; x < matte.cols; ++x) {
    const float line = left + (right - left) * (static_cast<float>(x) + 0.5f) / 320;
    const int top = x < island ? 150 + 17 * x % 40 : static_cast<int>(std::lround(line));
    matte.col(x).rowRange(top, matte.rows).setTo(255);
  }
  return matte;
}

TEST(Horizon, IsTheMattesStraightUpperBorder) {
  for (const auto& [left, right] : {std::pair{90.0f, 90.0f}, {84.0f, 96.0f}}) {
    const auto found = horizon_of(sea(left, right, 100));
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->from.y, left, 1);
    EXPECT_NEAR(found->to.y, right, 1);
    EXPECT_EQ(found->from.x, 0);
    EXPECT_EQ(found->to.x, 320);
  }
}

TEST(Horizon, IsNotABankNorThePicturesEdge) {
  EXPECT_FALSE(horizon_of(sea(90, 90, 180))) << "less than half of the width";
  EXPECT_FALSE(horizon_of(sea(60, 140))) << "steep";
  EXPECT_FALSE(horizon_of(cv::Mat(kPicture, CV_8U, cv::Scalar(255)))) << "to the picture's edge";
  EXPECT_FALSE(horizon_of(cv::Mat::zeros(kPicture, CV_8U)));
  cv::Mat pond = cv::Mat::zeros(kPicture, CV_8U);
  for (int x = 0; x < pond.cols; ++x)
    pond.col(x).rowRange(120 - static_cast<int>(60 * std::sin(x * CV_PI / 320)), 240).setTo(255);
  EXPECT_FALSE(horizon_of(pond));
}

TEST(Horizon, SpeedsAreThoseOfAPlaneUnderAPinhole) {
  // The slow way: a point of the plane and where it is a little later, both projected.
  const Horizon horizon{{0, 50}, {320, 50}};
  const double focal = 320, camera = 2;
  for (const cv::Vec2f& way : {cv::Vec2f(1, 0), cv::Vec2f(0, 1), cv::Vec2f(0.6f, 0.8f)}) {
    double unit = 0;
    for (const float y : {70.0f, 120.0f, 200.0f}) {
      const cv::Point2f place(160, y);
      // World directions whose image is `way`: solved by trying angles.
      double best = 2, speed = 0;
      const double depth = focal * camera / (y - 50), side = 0;
      for (double angle = 0; angle < 2 * CV_PI; angle += 1e-3) {
        const double step = 1e-4, later = depth - step * std::sin(angle), x = side + step * std::cos(angle);
        const cv::Vec2d moved(focal * x / later - focal * side / depth,
                              focal * camera / later - focal * camera / depth);
        const double off = 1 - moved.dot(cv::Vec2d(way)) / cv::norm(moved);
        if (off < best) best = off, speed = cv::norm(moved) / step;
      }
      const double ratio = speed / seen_speed(horizon, place, way, kPicture);
      if (unit == 0) unit = ratio;
      EXPECT_NEAR(ratio / unit, 1, 0.01) << y << " " << way;
    }
  }
  EXPECT_EQ(seen_speed(horizon, {160, 50}, {1, 0}, kPicture), 0);
  EXPECT_EQ(seen_speed(horizon, {160, 20}, {0, 1}, kPicture), 0);
}

}  // namespace
}  // namespace freshet::vision
