#include "media/picture/resized.h"

#include <gtest/gtest.h>

namespace freshet::media {
namespace {

TEST(Resized, HalfOfASideIsTheMeanOfWhatItCovers) {
  cv::Mat frame(2, 4, CV_8UC3, cv::Scalar::all(10));
  frame.colRange(2, 4) = cv::Scalar::all(50);
  frame.at<cv::Vec3b>(0, 0) = {30, 10, 10};
  const cv::Mat half = resized(frame, {2, 1});
  EXPECT_EQ(half.at<cv::Vec3b>(0, 0), cv::Vec3b(15, 10, 10));
  EXPECT_EQ(half.at<cv::Vec3b>(0, 1), cv::Vec3b(50, 50, 50));
}

TEST(Resized, TheSameSizeIsTheSameFrame) {
  const cv::Mat frame(5, 7, CV_16UC3, cv::Scalar::all(1234));
  EXPECT_EQ(resized(frame, frame.size()).data, frame.data);
}

TEST(Resized, ColoursThatAreNotSeenDoNotBleedIn) {
  for (const int depth : {CV_8U, CV_16U, CV_32F}) {
    const double white = depth == CV_8U ? 255 : depth == CV_16U ? 65535 : 1;
    cv::Mat frame(8, 8, CV_MAKETYPE(depth, 4), cv::Scalar(0, 0, white, 0));  // red, and not seen
    frame.colRange(4, 8) = cv::Scalar(0, white, 0, white);                   // green
    for (const cv::Size size : {cv::Size(3, 3), cv::Size(21, 21)}) {
      cv::Mat out;
      resized(frame, size, Colours::kStraight).convertTo(out, CV_32F, 1 / white);
      double most = 0;
      for (int x = 0; x < out.cols; ++x) {
        const cv::Vec4f pixel = out.at<cv::Vec4f>(1, x);
        EXPECT_EQ(pixel[2], 0) << depth << " at " << x;
        EXPECT_LE(pixel[3], 1);
        EXPECT_GE(pixel[1], 0);
        most = std::max(most, static_cast<double>(pixel[3]));
      }
      EXPECT_NEAR(most, 1, 1e-5);
    }
  }
}

TEST(Resized, GrownLightHasNoLightBelowNone) {
  cv::Mat frame(6, 6, CV_32FC3, cv::Scalar::all(0));
  frame.colRange(3, 6) = cv::Scalar::all(4);
  double least = 0, most = 0;
  cv::minMaxLoc(resized(frame, {24, 24}).reshape(1), &least, &most);
  EXPECT_GE(least, 0);
  EXPECT_GT(most, 4) << "of light there is no most";
}

}  // namespace
}  // namespace freshet::media
