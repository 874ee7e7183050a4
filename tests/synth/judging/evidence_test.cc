#include "synth/judging/evidence.h"

#include <gtest/gtest.h>

namespace freshet::synth::judging {
namespace {

TEST(JudgingEvidence, LargeFilmsAreReducedAndSmallOnesKept) {
  const cv::Mat large(480, 640, CV_8UC3, cv::Scalar(1, 2, 3)), matte(480, 640, CV_8U, cv::Scalar(255));
  Evidence film(large, matte, 25);
  film.add(large);
  EXPECT_EQ(film.size(), cv::Size(320, 240));
  EXPECT_EQ(film.picture(), cv::Size(640, 480));
  EXPECT_EQ(film.frames().front().size(), film.size());
  EXPECT_EQ(film.luma().front().type(), CV_8U);
  const cv::Mat small(20, 30, CV_8UC3, cv::Scalar(9, 9, 9));
  EXPECT_EQ(Evidence(small, cv::Mat(20, 30, CV_8U, cv::Scalar(255)), 25).size(), small.size());
}

TEST(JudgingEvidence, LongFilmsAreJudgedByTheirFirstFrames) {
  const cv::Mat frame(4, 4, CV_8UC3, cv::Scalar::all(0));
  Evidence film(frame, cv::Mat(4, 4, CV_8U, cv::Scalar(255)), 25);
  for (int i = 0; i < kJudgedFrames + 5; ++i) film.add(frame);
  EXPECT_EQ(film.count(), kJudgedFrames);
}

// A frame that the caller draws over later stays as it was.
TEST(JudgingEvidence, FramesAreCopied) {
  cv::Mat frame(4, 4, CV_8UC3, cv::Scalar::all(7));
  Evidence film(frame, cv::Mat(4, 4, CV_8U, cv::Scalar(255)), 25);
  film.add(frame);
  frame = cv::Scalar::all(200);
  EXPECT_EQ(film.frames().front().at<cv::Vec3b>(0, 0), cv::Vec3b(7, 7, 7));
}

}  // namespace
}  // namespace freshet::synth::judging
