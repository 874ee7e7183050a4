#include "synth/sampling/remapped.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::sampling {
namespace {

cv::Mat noise(cv::Size size, int type, double least, double most) {
  cv::Mat out(size, type);
  cv::RNG random(7);
  random.fill(out, cv::RNG::UNIFORM, cv::Scalar::all(least), cv::Scalar::all(most));
  return out;
}

TEST(Remapped, IsWhatOpenCvReadsInsideAndBeyond) {
  const cv::Mat places = noise({61, 37}, CV_32FC2, -6, 66);
  for (const int type : {CV_32FC1, CV_32FC2, CV_32FC4})
    for (const Beyond beyond : {Beyond::kEdge, Beyond::kZero}) {
      const cv::Mat plane = noise({55, 43}, type, -1, 1);
      cv::Mat found, expected;
      read_remapped(plane, places, beyond, found);
      cv::remap(plane, expected, places, cv::noArray(), cv::INTER_LINEAR,
                beyond == Beyond::kEdge ? cv::BORDER_REPLICATE : cv::BORDER_CONSTANT, cv::Scalar::all(0));
      ASSERT_EQ(found.type(), type);
      EXPECT_LT(cv::norm(found, expected, cv::NORM_INF), 1e-6) << type;
    }
}

TEST(Remapped, RoundsHalvesToTheEvenStep) {
  cv::Mat ramp(1, 4, CV_32F), places(1, 2, CV_32FC2), found;
  for (int x = 0; x < 4; ++x) ramp.at<float>(x) = 32.0f * static_cast<float>(x);
  places.at<cv::Vec2f>(0) = {1 + 0.5f / 32, 0};
  places.at<cv::Vec2f>(1) = {1 + 1.5f / 32, 0};
  read_remapped(ramp, places, Beyond::kEdge, found);
  EXPECT_EQ(found.at<float>(0), 32);
  EXPECT_EQ(found.at<float>(1), 34);
}

TEST(Remapped, PlacesFarAwayAreEdgesOrNothing) {
  const cv::Mat ones(5, 5, CV_32F, cv::Scalar(1));
  cv::Mat places(1, 3, CV_32FC2), found;
  places.at<cv::Vec2f>(0) = {1e9f, 2};
  places.at<cv::Vec2f>(1) = {2, -1e9f};
  places.at<cv::Vec2f>(2) = {-40000, 40000};
  read_remapped(ones, places, Beyond::kEdge, found);
  EXPECT_EQ(cv::countNonZero(found == 1), 3);
  read_remapped(ones, places, Beyond::kZero, found);
  EXPECT_EQ(cv::countNonZero(found), 0);
}

}  // namespace
}  // namespace freshet::synth::sampling
