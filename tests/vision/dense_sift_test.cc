#include "vision/dense_sift.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "tests/vision/made_texture.h"

namespace freshet::vision {
namespace {

class DenseSift : public testing::Test {
 protected:
  void SetUp() override { cv::setNumThreads(1); }  // as the executable does
};

double distance(const Descriptor& a, const Descriptor& b) {
  double sum = 0;
  for (int i = 0; i < kDescriptorSize; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

TEST_F(DenseSift, GivesEveryPointOfTheGridEvenOutsideTheFrame) {
  const cv::Mat frame = made_texture({70, 50});
  const DescriptorGrid grid = dense_sift(frame, {-40, -30}, 25, 31);
  ASSERT_EQ(grid.values.size(), 25u * 31u);
  for (const Descriptor& d : grid.values) {
    EXPECT_GT(*std::max_element(d.begin(), d.end()), 0);
  }
  EXPECT_TRUE(dense_sift(frame, {0, 0}, 0, 5).values.empty());
  EXPECT_EQ(dense_sift(frame(cv::Rect(0, 0, 1, 1)), {0, 0}, 9, 9).values.size(), 81u);
  EXPECT_THROW(dense_sift(cv::Mat(8, 8, CV_8UC3), {0, 0}, 1, 1), Error);
}

TEST_F(DenseSift, EqualsSiftOfTheWholeFrameInOnePiece) {
  // The slow twin: corners by a filter over the whole frame, one key point after the other.
  const cv::Mat frame = made_texture({260, 420});
  const int columns = 20, rows = 55, pitch = 6;
  const cv::Point origin(60, 40);
  cv::Mat corners;
  cv::boxFilter(frame, corners, CV_32F, {2, 2}, {1, 1}, true, cv::BORDER_REFLECT);
  corners.convertTo(corners, CV_8U, 1, 0.01);  // halves upwards
  const auto sift = cv::SIFT::create(0, 3, 0.04, 10, 1.6, CV_8U);
  const DescriptorGrid grid = dense_sift(frame, origin, columns, rows, pitch);
  int worst = 0;
  for (int row = 0; row < rows; row += 9) {
    for (int column = 0; column < columns; column += 5) {
      std::vector<cv::KeyPoint> points{{static_cast<float>(origin.x + column * pitch),
                                        static_cast<float>(origin.y + row * pitch), 4 / 1.5f, 0, 1, 0}};
      cv::Mat expected;
      sift->compute(corners, points, expected);
      for (int i = 0; i < kDescriptorSize; ++i) {
        worst = std::max(worst, std::abs(expected.at<std::uint8_t>(0, i) -
                                         grid.values[static_cast<std::size_t>(row) * columns + column][i]));
      }
    }
  }
  EXPECT_LE(worst, 1);
}

TEST_F(DenseSift, DoesNotDependOnWhatElseTheGridHolds) {
  const cv::Mat frame = made_texture({300, 400});
  const DescriptorGrid whole = dense_sift(frame, {0, 0}, 50, 66);
  const DescriptorGrid part = dense_sift(frame, {0, 6 * 30}, 50, 10);
  for (int i = 0; i < 50 * 10; ++i) EXPECT_EQ(part.values[i], whole.values[30 * 50 + i]);
}

TEST_F(DenseSift, IsTheSameOnAnyNumberOfThreads) {
  const cv::Mat frame = made_texture({300, 400});
  std::vector<Descriptor> first;
  for (const std::size_t threads : {1, 2, 8}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    const DescriptorGrid grid = dense_sift(frame, {0, 0}, 50, 66);
    if (first.empty()) first = grid.values;
    EXPECT_EQ(grid.values, first);
  }
}

TEST_F(DenseSift, MirroredDescriptorIsTheMirroredPicturesOwn) {
  const cv::Mat frame = made_texture({211, 180});
  cv::Mat mirror;
  cv::flip(frame, mirror, 1);
  const int columns = 25, rows = 20;
  const cv::Point origin(30, 25);
  const DescriptorGrid plain = dense_sift(frame, origin, columns, rows);
  // Corner x of the frame is corner width - x of its mirror image.
  const DescriptorGrid turned =
      dense_sift(mirror, {frame.cols - origin.x - (columns - 1) * 6, origin.y}, columns, rows);
  double worst = 0, mean = 0, unlike = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Descriptor& own = turned.values[static_cast<std::size_t>(row) * columns + columns - 1 - column];
      const Descriptor& given = plain.values[static_cast<std::size_t>(row) * columns + column];
      const double d = distance(mirrored(given), own);
      worst = std::max(worst, d);
      mean += d / (columns * rows);
      unlike += distance(given, own) / (columns * rows);
    }
  }
  RecordProperty("worst", std::to_string(worst));
  RecordProperty("mean", std::to_string(mean));
  EXPECT_LT(worst, 5) << "of a length of 512";
  EXPECT_LT(mean, 1);
  EXPECT_GT(unlike, 100);  // the permutation is not idle
}

TEST_F(DenseSift, MirroringTwiceIsTheIdentity) {
  const Descriptor descriptor = dense_sift(made_texture({60, 60}), {20, 30}, 1, 1).values[0];
  EXPECT_EQ(mirrored(mirrored(descriptor)), descriptor);
  EXPECT_NE(mirrored(descriptor), descriptor);
}

}  // namespace
}  // namespace freshet::vision
