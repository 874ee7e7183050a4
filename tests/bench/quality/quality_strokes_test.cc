#include "bench/quality/quality_strokes.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::bench {
namespace {

const cv::Size kPicture(640, 352);

cv::Mat motion_of(const std::function<cv::Vec2f(float x, float y)>& flow) {
  cv::Mat motion(kPicture / 4, CV_32FC2);
  for (int y = 0; y < motion.rows; ++y)
    for (int x = 0; x < motion.cols; ++x)
      motion.at<cv::Vec2f>(y, x) = flow(4 * static_cast<float>(x) + 2, 4 * static_cast<float>(y) + 2);
  return motion;
}
cv::Mat whole() { return cv::Mat(kPicture, CV_8U, cv::Scalar(255)); }

/// Cosine of the angle between a stroke's parts and the flow where they lie; the minimum.
double min_cosine(const hints::Stroke& stroke, const std::function<cv::Vec2f(float x, float y)>& flow) {
  double minimum = 1;
  for (std::size_t i = 1; i < stroke.points.size(); ++i) {
    const cv::Point2f along = stroke.points[i] - stroke.points[i - 1];
    const cv::Point2f middle = 0.5f * (stroke.points[i] + stroke.points[i - 1]);
    const cv::Vec2f here = flow(middle.x, middle.y);
    minimum = std::min(minimum, (along.x * here[0] + along.y * here[1]) / (cv::norm(along) * cv::norm(here)));
  }
  return minimum;
}

TEST(QualityStrokes, FollowTheFlow) {
  const auto whirl = [](float x, float y) { return cv::Vec2f(-(y - 176), x - 320) * 0.5f; };
  const std::vector<hints::Stroke> strokes = draw_strokes(motion_of(whirl), whole());
  ASSERT_GE(strokes.size(), 4u);
  EXPECT_LE(strokes.size(), 12u);
  for (const hints::Stroke& stroke : strokes) {
    ASSERT_GE(stroke.points.size(), 2u);
    EXPECT_GT(min_cosine(stroke, whirl), 0.9);
  }
}

TEST(QualityStrokes, TellSpeedToAFifth) {
  for (const float speed : {4.0f, 31.0f, 170.0f}) {
    const auto strokes = draw_strokes(motion_of([&](float, float) { return cv::Vec2f(0, speed); }), whole());
    ASSERT_FALSE(strokes.empty());
    for (const hints::Stroke& stroke : strokes) {
      EXPECT_LE(std::abs(std::log(*stroke.speed_px_per_s / speed)), std::log(1.2) / 2 + 1e-3);
      const double step = std::log(*stroke.speed_px_per_s) / std::log(1.2);
      EXPECT_NEAR(step, std::round(step), 1e-4);
    }
  }
}

TEST(QualityStrokes, StayInTheFluidAndAreFewerInLessOfIt) {
  cv::Mat matte = cv::Mat::zeros(kPicture, CV_8U);
  const cv::Rect fluid(100, 60, 200, 120);
  matte(fluid) = 255;
  const auto strokes = draw_strokes(motion_of([](float, float) { return cv::Vec2f(40, 0); }), matte);
  ASSERT_GE(strokes.size(), 2u);
  EXPECT_LE(strokes.size(), 6u);
  for (const hints::Stroke& stroke : strokes)
    for (const cv::Point2f& point : stroke.points) EXPECT_TRUE(fluid.contains(cv::Point(point)));
}

// Half a pixel before the right edge a point's pixel lies beyond it: below, the heap was written to.
TEST(QualityStrokes, EndWithinThePicture) {
  for (int slope = 0; slope < 20; ++slope)
    for (const hints::Stroke& stroke : draw_strokes(motion_of([&](float x, float) {
                                                      const float speed = x > 600 ? 4000 : 40;
                                                      return cv::Vec2f(speed, speed * slope / 40);
                                                    }),
                                                    whole()))
      for (const cv::Point2f& point : stroke.points)
        EXPECT_TRUE(cv::Rect({}, kPicture).contains(cv::Point(point))) << point;
}

TEST(QualityStrokes, AreNoneWhereNothingFlows) {
  EXPECT_TRUE(draw_strokes(motion_of([](float, float) { return cv::Vec2f(1, 1); }), whole()).empty());
}

TEST(QualityStrokes, GuideAsTheyPoint) {
  const auto strokes = draw_strokes(
      motion_of([](float x, float) { return x < 320 ? cv::Vec2f(0, 50) : cv::Vec2f(0, -100); }), whole());
  query::MotionGuide guide;
  guide_by(strokes, kPicture, false, guide);
  EXPECT_TRUE(guide.speed.empty());
  ASSERT_EQ(guide.direction.size(), kPicture);
  EXPECT_GT(guide.direction.at<cv::Vec2f>(176, 100)[1], 0.9);
  EXPECT_LT(guide.direction.at<cv::Vec2f>(176, 540)[1], -0.9);
  guide_by(strokes, kPicture, true, guide);
  EXPECT_NEAR(guide.speed.at<float>(176, 60), 50, 15);
  EXPECT_NEAR(guide.speed.at<float>(176, 580), 100, 30);
}

}  // namespace
}  // namespace freshet::bench
