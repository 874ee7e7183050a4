#include "synth/animate/frames/pieces_canvas.h"

#include <gtest/gtest.h>

namespace freshet::synth::animate {
namespace {

Placement pieces(double scale, std::vector<cv::Point> at) {
  Placement placement;
  placement.piece_scale = scale;
  for (const cv::Point& piece : at)
    placement.patches.push_back({.piece = piece, .clip = {}, .variant = {}, .patch = {}, .speed = 1});
  return placement;
}

/// Luma is x + 100 y.
cv::Mat ramp(cv::Size size) {
  cv::Mat out(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) out.at<float>(y, x) = static_cast<float>(x + 100 * y);
  return out;
}

TEST(PiecesCanvas, CutsThePictureWhereThePiecesLieAndReflectsItBeyond) {
  const cv::Size size(150, 90);
  const PiecesCanvas canvas(pieces(1, {{-24, 0}, {0, 24}, {120, 48}}), size);
  ASSERT_EQ(canvas.rect(), cv::Rect(-24, 0, 192, 96));
  const cv::Mat cut = canvas.cut(ramp(size));
  ASSERT_EQ(cut.size(), canvas.rect().size());
  const auto mirrored = [](int at, int n) { return at < 0 ? -at : at >= n ? 2 * (n - 1) - at : at; };
  for (int y = 0; y < cut.rows; ++y)
    for (int x = 0; x < cut.cols; ++x)
      ASSERT_EQ(cut.at<float>(y, x), mirrored(x - 24, size.width) + 100 * mirrored(y, size.height))
          << x << " " << y;
}

TEST(PiecesCanvas, OnAReducedPictureTakesMeansOfSquares) {
  const PiecesCanvas canvas(pieces(2, {{24, 0}}), {192, 96});
  const cv::Mat cut = canvas.cut(ramp({192, 96}));
  EXPECT_NEAR(cut.at<float>(5, 7), (2 * (24 + 7) + 0.5) + 100 * (2 * 5 + 0.5), 1e-2);
}

TEST(PiecesCanvas, ASampleStandsInTheMiddleOfItsSquare) {
  const PiecesCanvas canvas(pieces(1, {{24, 24}}), {192, 96});
  // Samples of a field that is the column's middle, px.
  cv::Mat samples(24, 48, CV_32F);
  for (int y = 0; y < samples.rows; ++y)
    for (int x = 0; x < samples.cols; ++x) samples.at<float>(y, x) = 4.0f * static_cast<float>(x) + 1.5f;
  const cv::Mat cut = canvas.cut_samples(samples, 4);
  for (const int x : {0, 9, 47}) EXPECT_NEAR(cut.at<float>(10, x), 24 + x, 0.1);
}

TEST(PiecesCanvas, GivesSamplesOfAPlaneWhereTheyStand) {
  const PiecesCanvas canvas(pieces(2, {{24, 0}}), {192, 96});
  cv::Mat plane(canvas.rect().size(), CV_32F);
  for (int y = 0; y < plane.rows; ++y)
    for (int x = 0; x < plane.cols; ++x) plane.at<float>(y, x) = static_cast<float>(x);
  const cv::Mat samples = canvas.sampled(plane, 4, {48, 24});
  // Sample 15 stands at 61.5 px of the picture, which is 30.5 of the reduced one and 6.5 of the canvas.
  EXPECT_NEAR(samples.at<float>(10, 15), 6.5, 0.05);
  EXPECT_EQ(samples.at<float>(10, 0), 0);    // left of it
  EXPECT_EQ(samples.at<float>(10, 47), 47);  // right of it
}

}  // namespace
}  // namespace freshet::synth::animate
