#include "synth/animate/frame_sheet.h"

#include <gtest/gtest.h>

namespace freshet::synth::animate {
namespace {

TEST(FrameSheet, IsCroppedToTheFluidAndHasALineBelowEachFrame) {
  const cv::Mat picture(400, 600, CV_8UC3, cv::Scalar(200, 0, 0));
  cv::Mat matte(400, 600, CV_8U, cv::Scalar(0));
  matte(cv::Rect(100, 50, 100, 200)).setTo(255);
  FrameSheet sheet(picture, matte, 20, {.fps = 25, .first_number = 1001, .shown = 2, .width_px = 480});
  EXPECT_EQ(sheet.region(), cv::Rect(84, 34, 132, 232));
  for (int i = 0; i < 20; ++i) sheet.add(cv::Mat(400, 600, CV_8UC3, cv::Scalar(0, 10 * i, 0)));
  const cv::Mat drawn = sheet.draw();
  EXPECT_EQ(drawn.cols, 3 * (132 + 4) + 4);
  EXPECT_EQ(drawn.at<cv::Vec3b>(100, 50), cv::Vec3b(200, 0, 0));
  EXPECT_EQ(drawn.at<cv::Vec3b>(100, 200), cv::Vec3b(0, 0, 0));
  EXPECT_EQ(drawn.at<cv::Vec3b>(100, 350), cv::Vec3b(0, 100, 0))
      << "the second of two is the tenth of twenty";
  // Words stand below the cells and below all.
  const auto has_ink = [&](const cv::Rect& region) {
    cv::Mat grey;
    cv::extractChannel(drawn(region), grey, 1);
    return cv::countNonZero(grey > 150) > 20;
  };
  EXPECT_TRUE(has_ink({4, 4 + 232, 132, 18}));
  EXPECT_TRUE(has_ink({0, drawn.rows - 36, drawn.cols, 18}));
  EXPECT_TRUE(has_ink({0, drawn.rows - 18, drawn.cols, 18})) << "that it is cropped";
}

TEST(FrameSheet, OfAWholePictureShowsAllOfIt) {
  const cv::Mat picture(40, 60, CV_8UC3, cv::Scalar::all(9)), matte(40, 60, CV_8U, cv::Scalar(255));
  EXPECT_EQ(FrameSheet(picture, matte, 3).region(), cv::Rect(0, 0, 60, 40));
}

}  // namespace
}  // namespace freshet::synth::animate
