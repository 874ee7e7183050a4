#include "synth/animate/clips/clip_luma.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "freshet/error.h"
#include "tests/synth/animate/flowing_clip.h"

namespace freshet::synth::animate {
namespace {

double keys(double t) {
  constexpr double a = -0.75;
  t = std::abs(t);
  if (t < 1) return ((a + 2) * t - (a + 3)) * t * t + 1;
  return t < 2 ? ((a * t - 5 * a) * t + 8 * a) * t - 4 * a : 0;
}

/// Luma of whole frames, 0..1, as the layout has it.
cv::Mat luma_of(const FlowingStore& store, const FlowingClip& clip, int i) {
  return media::luma_from_plane(stored::ClipFrames(store.snapshot(), store.id()).layout(), clip.frame(i));
}

/// A component of the flow at a pixel of the frame reduced by so much, px of that: between samples, which stand in the
/// middles of theirs.
double flow_at(const cv::Mat& flow, int step, int x, int y, int by = 1) {
  const double fx = std::clamp((x + 0.5) * by / step - 0.5, 0.0, flow.cols - 1.0);
  const double fy = std::clamp((y + 0.5) * by / step - 0.5, 0.0, flow.rows - 1.0);
  const int x0 = static_cast<int>(fx), y0 = static_cast<int>(fy);
  const int x1 = std::min(x0 + 1, flow.cols - 1), y1 = std::min(y0 + 1, flow.rows - 1);
  const auto at = [&](int px, int py) { return flow.at<std::int16_t>(py, px) / (64.0 * by); };
  const double upper = at(x0, y0) + (fx - x0) * (at(x1, y0) - at(x0, y0));
  const double lower = at(x0, y1) + (fx - x0) * (at(x1, y1) - at(x0, y1));
  return upper + (fy - y0) * (lower - upper);
}

/// Cubic, beyond the frame its edge.
double read_at(const cv::Mat& luma, double x, double y) {
  x = std::round(std::clamp<double>(x, -1, luma.cols) * 64) / 64;
  y = std::round(std::clamp<double>(y, -1, luma.rows) * 64) / 64;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  double sum = 0;
  for (int row = y0 - 1; row <= y0 + 2; ++row)
    for (int column = x0 - 1; column <= x0 + 2; ++column)
      sum += keys(x - column) * keys(y - row) *
             static_cast<double>(
                 luma.at<float>(std::clamp(row, 0, luma.rows - 1), std::clamp(column, 0, luma.cols - 1)));
  return sum;
}

/// The moment `fraction` between two frames at one pixel, as the header says it.
double between(const std::array<cv::Mat, 2>& flow, int step, double fraction, const cv::Mat& before,
               const cv::Mat& after, cv::Point at) {
  const double u = flow_at(flow[0], step, at.x, at.y);
  const double v = flow_at(flow[1], step, at.x, at.y);
  const double from = read_at(before, at.x - fraction * u, at.y - fraction * v);
  const double to = read_at(after, at.x + (1 - fraction) * u, at.y + (1 - fraction) * v);
  // 0.1 of luma apart, the nearer one counts alone, or nearly.
  const double w = std::clamp(0.5 + (fraction - 0.5) * (1 + 40 * std::abs(to - from)), 0.0, 1.0);
  return from + w * (to - from);
}

const cv::Rect kWhole(0, 0, 150, 110);

std::vector<cv::Rect> cells() {
  std::vector<cv::Rect> cells;
  for (int y = 0; y < kWhole.height; y += ClipLuma::kCellHeight)
    for (int x = 0; x < kWhole.width; x += ClipLuma::kCellWidth)
      cells.push_back(cv::Rect(x, y, ClipLuma::kCellWidth, ClipLuma::kCellHeight) & kWhole);
  return cells;
}

class OfEitherRange : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(ClipLuma, OfEitherRange, ::testing::Values(1, 2));

TEST_P(OfEitherRange, LumaOfAWholeMomentIsTheFramesOwn) {
  const FlowingClip clip{.range = GetParam()};
  const FlowingStore store({clip});
  ClipLuma luma(store.snapshot(), store.id(), ClipLuma::Size::kWhole, std::vector{kWhole}, clip.flow_step);
  luma.load(std::vector<std::uint32_t>{0, 7, 16, 19});
  ClipLuma::Scratch scratch;
  std::vector<float> out(ClipLuma::kCellWidth * ClipLuma::kCellHeight), row(kWhole.width);
  for (const int i : {0, 7, 16, 19}) {
    const cv::Mat expected = luma_of(store, clip, i);
    for (const cv::Rect& cell : cells()) {
      luma.at(i, cell, out.data(), scratch);
      for (int y = 0; y < cell.height; ++y)
        for (int x = 0; x < cell.width; ++x)
          ASSERT_NEAR(out[y * cell.width + x], expected.at<float>(cell.y + y, cell.x + x), 1e-6)
              << i << " " << cell;
    }
    for (int y = 0; y < kWhole.height; ++y) {
      luma.row(static_cast<std::uint32_t>(i), 3, y, kWhole.width - 3, row.data());
      for (int x = 3; x < kWhole.width; ++x) ASSERT_NEAR(row[x - 3], expected.at<float>(y, x), 1e-6);
    }
  }
}

class AtEveryFlowStep : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(ClipLuma, AtEveryFlowStep, ::testing::Values(1, 2, 3));

TEST_P(AtEveryFlowStep, AMomentBetweenFramesIsMadeOfBothAlongTheFlow) {
  const FlowingClip clip{.flow_step = GetParam(), .steady = {1.5f, -0.7f}, .varying = 2};
  const FlowingStore store({clip});
  ClipLuma luma(store.snapshot(), store.id(), ClipLuma::Size::kWhole, std::vector{kWhole}, clip.flow_step);
  luma.load(std::vector<std::uint32_t>{4, 5, 15, 16}, std::vector<std::uint32_t>{4, 15});
  ClipLuma::Scratch scratch;
  std::vector<float> out(ClipLuma::kCellWidth * ClipLuma::kCellHeight);
  for (const int i : {4, 15}) {
    const cv::Mat before = luma_of(store, clip, i), after = luma_of(store, clip, i + 1);
    const auto flow = clip.flow(i);
    double sum = 0, pixels = 0;
    for (const double fraction : {0.25, 0.6})
      for (const cv::Rect& cell : cells()) {
        luma.at(i + fraction, cell, out.data(), scratch);
        for (int y = 0; y < cell.height; y += 3)
          for (int x = 0; x < cell.width; x += 3) {
            const double off =
                std::abs(static_cast<double>(out[y * cell.width + x]) -
                         between(flow, clip.flow_step, fraction, before, after, cell.tl() + cv::Point(x, y)));
            // A place may round to the next 64th of a pixel in single precision.
            ASSERT_LT(off, 0.02) << cell << " " << x << " " << y;
            sum += off, ++pixels;
          }
      }
    EXPECT_LT(sum / pixels, 1e-4);
  }
}

/// Means of squares of two by two, of odd sides' last row and column with itself.
cv::Mat halved(const cv::Mat& luma) {
  cv::Mat half((luma.rows + 1) / 2, (luma.cols + 1) / 2, CV_32F);
  for (int y = 0; y < half.rows; ++y)
    for (int x = 0; x < half.cols; ++x) {
      const int right = std::min(2 * x + 1, luma.cols - 1), below = std::min(2 * y + 1, luma.rows - 1);
      half.at<float>(y, x) = (luma.at<float>(2 * y, 2 * x) + luma.at<float>(2 * y, right) +
                              luma.at<float>(below, 2 * x) + luma.at<float>(below, right)) /
                             4;
    }
  return half;
}

TEST_P(AtEveryFlowStep, AnInnovationIsWhatCarryingTheNeighboursDoesNotExplain) {
  for (const cv::Size size : {cv::Size(150, 110), cv::Size(151, 111)}) {
    const FlowingClip clip{.size = size, .flow_step = GetParam(), .steady = {2.5f, -1.7f}, .varying = 2};
    const FlowingStore store({clip});
    const cv::Size half((size.width + 1) / 2, (size.height + 1) / 2);
    ClipLuma luma(store.snapshot(), store.id(), ClipLuma::Size::kHalf, std::vector{cv::Rect({}, half)},
                  clip.flow_step);
    EXPECT_EQ(luma.source(), half);
    EXPECT_EQ(luma.region(), cv::Rect({}, half));
    luma.load(std::vector<std::uint32_t>{0, 1, 9, 10, 11}, std::vector<std::uint32_t>{0, 9, 10});
    ClipLuma::Scratch scratch;
    std::vector<float> out(ClipLuma::kCellWidth * ClipLuma::kCellHeight), row(half.width);
    const auto carried = [&](int frame, int flow, double way, cv::Point at) {
      const double u = flow_at(clip.flow(flow)[0], clip.flow_step, at.x, at.y, 2);
      const double v = flow_at(clip.flow(flow)[1], clip.flow_step, at.x, at.y, 2);
      return read_at(halved(luma_of(store, clip, frame)), at.x + way * u, at.y + way * v);
    };
    const cv::Rect cell(half.width - ClipLuma::kCellWidth, half.height - ClipLuma::kCellHeight,
                        ClipLuma::kCellWidth, ClipLuma::kCellHeight);
    for (const int i : {0, 10}) {
      const cv::Mat own = halved(luma_of(store, clip, i));
      luma.row(static_cast<std::uint32_t>(i), 1, half.height - 1, half.width - 1, row.data());
      for (int x = 1; x < half.width; ++x)
        ASSERT_NEAR(row[x - 1], own.at<float>(half.height - 1, x), 1e-6) << x;
      luma.innovation(static_cast<std::uint32_t>(i), cell, out.data(), scratch);
      double sum = 0, pixels = 0;
      for (int y = 0; y < cell.height; y += 5)
        for (int x = 0; x < cell.width; x += 5) {
          const cv::Point at = cell.tl() + cv::Point(x, y);
          const double after = carried(i + 1, i, 1, at),
                       before = i > 0 ? carried(i - 1, i - 1, -1, at) : after;
          const double off = std::abs(out[y * cell.width + x] - (own.at<float>(at) - (before + after) / 2));
          ASSERT_LT(off, 0.02) << i << " " << at;
          sum += off, ++pixels;
        }
      EXPECT_LT(sum / pixels, 1e-4);
    }
  }
}

TEST(ClipLuma, AtHalfSizeKnowsOnlyTheBlocksThatAreNeeded) {
  const FlowingClip clip;
  const FlowingStore store({clip});
  ClipLuma luma(store.snapshot(), store.id(), ClipLuma::Size::kHalf, std::vector{cv::Rect(35, 35, 5, 5)},
                clip.flow_step);
  EXPECT_EQ(luma.region(), cv::Rect(32, 32, 32, 55 - 32));
  luma.load(std::vector<std::uint32_t>{3});
  std::vector<float> row(32);
  luma.row(3, 32, 54, 32, row.data());
  const cv::Mat expected = halved(luma_of(store, clip, 3));
  for (int x = 0; x < 32; ++x) EXPECT_NEAR(row[x], expected.at<float>(54, 32 + x), 1e-6);
  EXPECT_NEAR(luma.mean(3, std::vector{cv::Point(40, 40), cv::Point(60, 54)}),
              (expected.at<float>(40, 40) + expected.at<float>(54, 60)) / 2, 1e-6);
}

TEST(ClipLuma, KnowsOnlyTheBlocksThatAreNeeded) {
  const FlowingClip clip;
  const FlowingStore store({clip});
  ClipLuma luma(store.snapshot(), store.id(), ClipLuma::Size::kWhole, std::vector{cv::Rect(70, 70, 10, 10)},
                clip.flow_step);
  EXPECT_EQ(luma.region(), cv::Rect(64, 64, 64, 110 - 64));
  ASSERT_EQ(luma.blocks().size(), 1u);
  EXPECT_EQ(luma.frame_bytes(), 64u * 46u);
  luma.load(std::vector<std::uint32_t>{3});
  std::vector<float> row(64);
  luma.row(3, 64, 80, 64, row.data());
  const cv::Mat expected = luma_of(store, clip, 3);
  for (int x = 0; x < 64; ++x) EXPECT_NEAR(row[x], expected.at<float>(80, 64 + x), 1e-6);
}

TEST(ClipLuma, WhatIsKeptWhenOtherFramesAreLoadedIsTheSame) {
  const FlowingClip clip{.varying = 3};
  const FlowingStore store({clip});
  ClipLuma at_once(store.snapshot(), store.id(), ClipLuma::Size::kWhole, std::vector{kWhole}, clip.flow_step),
      step_by_step(store.snapshot(), store.id(), ClipLuma::Size::kWhole, std::vector{kWhole}, clip.flow_step);
  at_once.load(std::vector<std::uint32_t>{9, 10}, std::vector<std::uint32_t>{9});
  step_by_step.load(std::vector<std::uint32_t>{2, 9, 18}, std::vector<std::uint32_t>{2, 18});
  step_by_step.load(std::vector<std::uint32_t>{9, 10}, std::vector<std::uint32_t>{9});
  ClipLuma::Scratch scratch;
  const std::size_t size = ClipLuma::kCellWidth * ClipLuma::kCellHeight;
  std::vector<float> a(size), b(size);
  for (const cv::Rect& cell : cells()) {
    at_once.at(9.5, cell, a.data(), scratch);
    step_by_step.at(9.5, cell, b.data(), scratch);
    EXPECT_EQ(a, b);
  }
}

TEST(ClipLuma, RefusesAFlowThatDoesNotFitItsFrames) {
  const FlowingClip clip;
  const FlowingStore store({clip});
  ClipLuma luma(store.snapshot(), store.id(), ClipLuma::Size::kWhole, std::vector{kWhole},
                clip.flow_step + 1);
  luma.load(std::vector<std::uint32_t>{0, 1});
  EXPECT_THROW(luma.load(std::vector<std::uint32_t>{0, 1}, std::vector<std::uint32_t>{0}), Error);
}

}  // namespace
}  // namespace freshet::synth::animate
