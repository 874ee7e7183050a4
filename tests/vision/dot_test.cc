#include "vision/dot.h"

#include <cstdint>

#include <gtest/gtest.h>

namespace freshet::vision {
namespace {

cv::Mat noise(cv::Size size, int type, std::uint64_t seed) {
  cv::Mat out(size, type);
  cv::RNG random(seed);
  random.fill(out, cv::RNG::UNIFORM, -1, 3);
  return out;
}

/// As the header says it: each of every eighth product of a row, and these eight at last.
double by_loops(const cv::Mat& one, const cv::Mat& other) {
  double sums[8] = {}, all = 0;
  for (int y = 0; y < one.rows; ++y)
    for (int i = 0; i < one.cols * one.channels(); ++i)
      sums[i % 8] += double{one.ptr<float>(y)[i]} * double{other.ptr<float>(y)[i]};
  for (const double sum : sums) all += sum;
  return all;
}

TEST(Dot, OfMagnitudesIsThatOfAbsoluteValues) {
  const cv::Mat one = noise({123, 5}, CV_32FC1, 1), other = noise({123, 5}, CV_32FC1, 2);
  EXPECT_EQ(dot_of_magnitudes(one, other), dot(cv::abs(one), other));
}

TEST(Dot, IsTheLoopsToTheBitForAnyWidthOfRows) {
  for (const int columns : {1, 7, 8, 9, 64, 123})
    for (const int type : {CV_32FC1, CV_32FC2, CV_32FC3}) {
      const cv::Mat one = noise({columns, 5}, type, 1), other = noise({columns, 5}, type, 2);
      EXPECT_EQ(dot(one, other), by_loops(one, other)) << columns;
      EXPECT_NEAR(dot(one, other), one.dot(other), 1e-4 * columns);
    }
}

TEST(Dot, OfAPartIsThatPartsOwn) {
  const cv::Mat one = noise({60, 40}, CV_32F, 3), other = noise({60, 40}, CV_32F, 4);
  const cv::Rect part(7, 5, 31, 22);
  EXPECT_EQ(dot(one(part), other(part)), dot(one(part).clone(), other(part).clone()));
}

}  // namespace
}  // namespace freshet::vision
