#include "synth/animate/blend/blend.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "tests/harness/noise.h"

namespace freshet::synth::animate {
namespace {

constexpr int kFrames = 3;

/// Pieces in a grid; every piece from a clip of its own, or all from one clip, in place.
Placement grid(int columns, int rows, bool one_clip, int stride = 24) {
  Placement placement{.side = 48, .stride = stride, .patches = {}};
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const cv::Point at(column * placement.stride, row * placement.stride);
      const auto clip = store::ClipId{one_clip ? 0u : static_cast<std::uint32_t>(row * columns + column)};
      placement.patches.push_back({.piece = at, .clip = clip, .variant = {}, .patch = at});
    }
  return placement;
}

double deviation(const cv::Mat& field) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(field, mean, deviation);
  return deviation[0];
}

/// The middle of a canvas, where every pixel has all of its pieces.
cv::Mat middle(const cv::Mat& field) { return field(cv::Rect(48, 48, field.cols - 96, field.rows - 96)); }

cv::Mat blend_noise(const Placement& placement, const BlendOptions& options) {
  Blender blender(placement, 1, options);
  for (std::size_t p = 0; p < placement.patches.size(); ++p) {
    cv::Mat piece = normal_noise({48, 48}, p + 1, 0, 0.1);
    piece -= cv::mean(piece)[0];
    blender.add(0, p, piece);
  }
  return blender.take(0);
}

TEST(Blend, ShowsOneClipAsItIs) {
  const Placement placement = grid(6, 5, true);
  const cv::Mat frame = normal_noise(canvas_of(placement).size(), 7, 0, 0.1);
  for (BlendWeights weights : {BlendWeights::kPaper, BlendWeights::kVariance}) {
    Blender blender(placement, 1, {.weights = weights, .low_band = LowBand::kKeep});
    for (std::size_t p = 0; p < placement.patches.size(); ++p)
      blender.add(0, p, frame(cv::Rect(placement.patches[p].piece, cv::Size(48, 48))));
    // A piece's own pyramid ends at its edge, so bands differ there a little from the frame's.
    const cv::Mat difference = middle(blender.take(0)) - middle(frame);
    EXPECT_LT(deviation(difference), 0.03 * deviation(frame));
  }
}

TEST(Blend, ShowsOneClipAsItIsWhateverTheStride) {
  for (int stride : {12, 24, 36}) {
    const Placement placement = grid(12, 12, true, stride);
    cv::Mat frame = normal_noise(canvas_of(placement).size(), 7, 0, 0.1);
    cv::GaussianBlur(frame, frame, {}, 4);  // what the coarse levels carry
    Blender blender(placement, 1, {.low_band = LowBand::kKeep});
    for (std::size_t p = 0; p < placement.patches.size(); ++p)
      blender.add(0, p, frame(cv::Rect(placement.patches[p].piece, cv::Size(48, 48))));
    const cv::Mat difference = middle(blender.take(0)) - middle(frame);
    EXPECT_LT(deviation(difference), 0.1 * deviation(frame)) << stride;
  }
}

TEST(Placement, IsRefusedWhenItsPiecesCannotBeBlended) {
  EXPECT_NO_THROW(check(grid(2, 2, true)));
  EXPECT_NO_THROW(check(grid(2, 2, true, 12)));
  EXPECT_NO_THROW(check(grid(2, 2, true, 48)));
  EXPECT_THROW(check(grid(0, 0, true)), Error);
  for (int stride : {1, 8, 18, 52}) EXPECT_THROW(check(grid(2, 2, true, stride)), Error) << stride;
  Placement odd = grid(1, 1, true);
  odd.side = 46;
  EXPECT_THROW(check(odd), Error);
}

TEST(Blend, VarianceWeightsKeepTheContrastOfUnrelatedPieces) {
  const Placement placement = grid(8, 8, false);
  const double before = deviation(normal_noise({480, 480}, 99, 0, 0.1));
  const double variance = deviation(middle(blend_noise(placement, {.weights = BlendWeights::kVariance})));
  const double paper = deviation(middle(blend_noise(placement, {.weights = BlendWeights::kPaper})));
  EXPECT_NEAR(variance / before, 1, 0.06);
  EXPECT_LT(paper, 0.97 * variance);
}

TEST(Blend, SharedLowBandKeepsWhatNeighboursDoTogether) {
  const Placement placement = grid(9, 9, false);
  for (bool together : {true, false}) {
    Blender blender(placement, kFrames, {.low_band = LowBand::kShared});
    cv::RNG rng(5);
    for (int frame = 0; frame < kFrames; ++frame)
      for (std::size_t p = 0; p < placement.patches.size(); ++p) {
        const double level = together ? 0.2 : rng.gaussian(0.2);
        blender.add(frame, p, cv::Mat(48, 48, CV_32F, cv::Scalar(level)));
      }
    for (int frame = 0; frame < kFrames; ++frame) {
      const cv::Mat field = middle(blender.take(frame));
      if (together)
        EXPECT_NEAR(cv::mean(field)[0], 0.2, 1e-4);
      else
        EXPECT_LT(deviation(field), 0.04);
    }
  }
}

TEST(Blend, RemovedLowBandLeavesNoLevel) {
  const Placement placement = grid(4, 4, false);
  Blender blender(placement, 1, {.low_band = LowBand::kRemove});
  for (std::size_t p = 0; p < placement.patches.size(); ++p)
    blender.add(0, p, cv::Mat(48, 48, CV_32F, cv::Scalar(0.3)));
  EXPECT_LT(cv::norm(blender.take(0), cv::NORM_INF), 1e-5);
}

TEST(Blend, IsZeroWhereNoPieceLies) {
  Placement placement = grid(5, 1, false);
  placement.patches.erase(placement.patches.begin() + 1, placement.patches.begin() + 4);
  const cv::Mat field = blend_noise(placement, {.low_band = LowBand::kKeep});
  // The coarsest band's interpolation reaches a little beyond a piece.
  EXPECT_LT(cv::norm(field(cv::Rect(60, 8, 24, 32)), cv::NORM_INF), 1e-3);
  EXPECT_GT(deviation(field(cv::Rect(8, 8, 32, 32))), 0.05);
}

}  // namespace
}  // namespace freshet::synth::animate
