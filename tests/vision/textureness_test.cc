#include "vision/textureness.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"

namespace freshet::vision {
namespace {

// Detail of all sizes: noise at several blurs.
cv::Mat texture(cv::Size size, int seed) {
  cv::Mat sum = cv::Mat::zeros(size, CV_32F), noise(size, CV_32F);
  for (const double sigma : {0.7, 2.0, 5.0, 12.0}) {
    cv::RNG(seed++).fill(noise, cv::RNG::NORMAL, 0, 1);
    cv::GaussianBlur(noise, noise, {}, sigma);
    sum += noise * (25 * sigma);
  }
  sum.convertTo(sum, CV_8U, 1, 128);
  return sum;
}

// The slow and obvious twin: all Gaussians at full size.
float slow(const std::vector<cv::Mat>& frames, int level, cv::Rect cell) {
  double sum = 0;
  for (const cv::Mat& frame : frames) {
    cv::Mat picture, fine, coarse;
    frame.convertTo(picture, CV_32F, 1.0 / 255);
    cv::GaussianBlur(picture, fine, {}, 1 << level, 0, cv::BORDER_REFLECT);
    cv::GaussianBlur(picture, coarse, {}, 2 << level, 0, cv::BORDER_REFLECT);
    sum += cv::mean(cv::abs(fine - coarse)(cell))[0];
  }
  return static_cast<float>(sum / static_cast<double>(frames.size()));
}

TEST(Textureness, EqualsGaussiansAtFullSize) {
  const cv::Size size(152, 136);
  const std::vector<cv::Mat> frames{texture(size, 1), texture(size, 11)};
  TexturenessAccumulator accumulator(size, 1, 4);
  for (const cv::Mat& frame : frames) accumulator.add(frame);
  const CellMap cells = accumulator.finish();
  ASSERT_EQ(cells.rows, 34);
  ASSERT_EQ(cells.columns, 38);
  ASSERT_EQ(cells.channels, kTextureLevels);
  EXPECT_EQ(cells.cell, 4);
  constexpr std::array kTolerance{0.001, 0.05, 0.02, 0.025};
  for (int level = 0; level < kTextureLevels; ++level) {
    double error = 0, mean = 0;
    int count = 0;
    for (int row = 0; row < cells.rows; row += 3) {
      for (int column = 0; column < cells.columns; column += 5) {
        const cv::Rect cell = cv::Rect(column * 4, row * 4, 4, 4) & cv::Rect({}, size);
        const double expected = slow(frames, level, cell);
        error += std::pow(cells.at(row, column)[level] - expected, 2);
        mean += expected;
        ++count;
      }
    }
    const double relative = std::sqrt(error / count) / (mean / count);
    RecordProperty("level_" + std::to_string(level), std::to_string(relative));
    EXPECT_LT(relative, kTolerance[level]) << level;
    EXPECT_GT(mean / count, 0.005);
  }
}

TEST(Textureness, DetailOfASizeShowsInItsOwnLevel) {
  // A grating of wavelength w is strongest where the difference of Gaussians passes it: near sigma = w / 6.
  for (int level = 0; level < kTextureLevels; ++level) {
    cv::Mat grating(128, 192, CV_8U);
    for (int x = 0; x < grating.cols; ++x)
      grating.col(x) = 128 + 100 * std::sin(x * 2 * CV_PI / (6.0 * (1 << level)));
    TexturenessAccumulator accumulator(grating.size(), 1, 4);
    accumulator.add(grating);
    const auto cell = accumulator.finish();
    const auto values = cell.at(16, 24);
    EXPECT_EQ(std::max_element(values.begin(), values.end()) - values.begin(), level);
  }
}

TEST(Textureness, ScaledCellsAreLargerInTheSource) {
  const cv::Mat frame = texture({160, 120}, 3);
  TexturenessAccumulator accumulator(frame.size(), 0.5f, 4);
  accumulator.add(frame);
  const CellMap half = accumulator.finish();
  EXPECT_EQ(half.rows, 15);
  EXPECT_EQ(half.columns, 20);
  EXPECT_EQ(half.cell, 8);
  cv::Mat reduced;
  cv::resize(frame, reduced, {80, 60}, 0, 0, cv::INTER_AREA);
  EXPECT_NEAR(half.at(7, 9)[0], slow({reduced}, 0, {36, 28, 4, 4}), 0.002);
}

TEST(Textureness, FlatPicturesHaveNone) {
  TexturenessAccumulator accumulator({50, 40}, 0.75f, 4);
  accumulator.add(cv::Mat(40, 50, CV_8U, cv::Scalar(200)));
  for (const float value : accumulator.finish().values) EXPECT_LT(value, 1e-6);
}

TEST(Textureness, IsTheSameOnAnyNumberOfThreads) {
  const cv::Mat frame = texture({333, 411}, 4);
  std::vector<float> first;
  for (const std::size_t threads : {1, 2, 8}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    TexturenessAccumulator accumulator(frame.size(), 1, 4);
    accumulator.add(frame);
    const CellMap cells = accumulator.finish();
    if (first.empty()) first = cells.values;
    EXPECT_EQ(cells.values, first);
  }
}

TEST(Textureness, RefusesWhatDoesNotFit) {
  TexturenessAccumulator accumulator({50, 40}, 1, 4);
  EXPECT_THROW(accumulator.finish(), Error);
  EXPECT_THROW(accumulator.add(cv::Mat(50, 40, CV_8U)), Error);
  EXPECT_THROW(TexturenessAccumulator({50, 40}, 0, 4), Error);
}

}  // namespace
}  // namespace freshet::vision
