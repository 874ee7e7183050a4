#include "vision/sift_points.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "tests/vision/made_texture.h"

namespace freshet::vision {
namespace {

TEST(SiftPoints, AreTheDenseGridsOwn) {
  const cv::Mat frame = made_noise({300, 400});
  const int columns = 40, rows = 60;
  const DescriptorGrid whole = dense_sift(frame, {-6, 12}, columns, rows);
  // Of the second strip of 24 rows no point, of the others the first, the last and some.
  std::vector<std::uint32_t> points{0, 7, 24 * columns - 1};
  for (std::uint32_t point = 48 * columns; point < 60 * columns; point += 11) points.push_back(point);
  points.push_back(columns * rows - 1);
  const std::vector<Descriptor> some = sift_points(frame, {-6, 12}, columns, rows, 6, points);
  ASSERT_EQ(some.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_EQ(some[i], whole.values[points[i]]) << "point " << points[i];
}

TEST(SiftPoints, NoneIsNothingAndOneBeyondTheGridAnError) {
  const cv::Mat frame = made_noise({60, 60});
  EXPECT_TRUE(sift_points(frame, {0, 0}, 9, 9, 6, {}).empty());
  const std::uint32_t beyond[] = {3, 81};
  EXPECT_THROW(sift_points(frame, {0, 0}, 9, 9, 6, beyond), Error);
}

}  // namespace
}  // namespace freshet::vision
