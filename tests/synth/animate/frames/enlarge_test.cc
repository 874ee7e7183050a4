#include "synth/animate/frames/enlarge.h"

#include <gtest/gtest.h>

#include <cmath>

#include <opencv2/imgproc.hpp>

#include "synth/animate/placement/placement.h"

namespace freshet::synth::animate {
namespace {

TEST(Enlarge, AddsPixelByPixelAtScaleOneAndNothingBeyondTheCanvas) {
  cv::Mat field(48, 72, CV_32F), luma(40, 100, CV_32F, cv::Scalar(0.5));
  cv::randu(field, -1, 1);
  const cv::Rect canvas(-4, -4, 72, 48);
  add_enlarged(field, canvas, 1, luma);
  for (int y = 0; y < luma.rows; ++y)
    for (int x = 0; x < luma.cols; ++x)
      ASSERT_EQ(luma.at<float>(y, x), x < 68 ? 0.5f + field.at<float>(y + 4, x + 4) : 0.5f) << x << ", " << y;
}

TEST(Enlarge, ShowsTheSamePlacesAtAnyScale) {
  // A field that says where it is. Bicubic interpolation (a = -3/4) keeps a slope to an eighth of a pixel.
  for (const double scale : {1.5, 3.0}) {
    const cv::Size picture(240, 180);
    const cv::Rect canvas(-8, -8, 192, 144);
    cv::Mat field(canvas.size(), CV_32F);
    for (int y = 0; y < field.rows; ++y)
      for (int x = 0; x < field.cols; ++x)
        field.at<float>(y, x) = static_cast<float>((x + canvas.x + 0.5) * scale - 0.5);
    cv::Mat luma = cv::Mat::zeros(picture, CV_32F);
    add_enlarged(field, canvas, scale, luma);
    for (int y = 8; y < picture.height - 8; ++y)
      for (int x = 8; x < picture.width - 8; ++x) ASSERT_NEAR(luma.at<float>(y, x), x, 0.125) << scale;
  }
}

TEST(Enlarge, SquaresOfThePlacementLieUnderThePixelsThatTheyMove) {
  const Placement placement{.side = 48, .stride = 24, .piece_scale = 3, .patches = {}};
  // The first square of 8 px at (16, -8) of the reduced picture: px 48..71 and -24..-1 of the picture.
  const cv::Matx23d m = squares_from_picture(placement, {16, -8}, 8, {300, 150});
  const cv::Vec2d middle = m * cv::Vec3d(59.5, -12.5, 1), next = m * cv::Vec3d(83.5, 11.5, 1);
  EXPECT_NEAR(middle[0], 0, 1e-9);
  EXPECT_NEAR(middle[1], 0, 1e-9);
  EXPECT_NEAR(next[0], 1, 1e-9);
  EXPECT_NEAR(next[1], 1, 1e-9);
}

}  // namespace
}  // namespace freshet::synth::animate
