#include "synth/sampling/pull_push.h"

#include <gtest/gtest.h>

namespace freshet::synth::sampling {
namespace {

TEST(PullPush, LeavesWhatIsTrustedAndContinuesIt) {
  const cv::Size size(97, 61);
  cv::Mat values(size, CV_32FC3, cv::Scalar(9, 9, 9)), weight = cv::Mat::zeros(size, CV_32F);
  const cv::Rect known(10, 20, 20, 15);
  values(known).setTo(cv::Scalar(0.25, 0.5, 0.75));
  weight(known).setTo(1);
  const cv::Mat out = pull_push(values, weight);
  EXPECT_LT(cv::norm(out, cv::Mat(size, CV_32FC3, cv::Scalar(0.25, 0.5, 0.75)), cv::NORM_INF), 1e-4);
}

TEST(PullPush, TheNearerValueCountsMore) {
  const cv::Size size(128, 64);
  cv::Mat values = cv::Mat::zeros(size, CV_32F), weight = cv::Mat::zeros(size, CV_32F);
  values.colRange(118, 128).setTo(1);
  weight.colRange(0, 10).setTo(1);
  weight.colRange(118, 128).setTo(1);
  const cv::Mat out = pull_push(values, weight);
  EXPECT_LT(out.at<float>(32, 20), 0.25);
  EXPECT_GT(out.at<float>(32, 107), 0.75);
  EXPECT_EQ(out.at<float>(32, 5), 0);
  EXPECT_EQ(out.at<float>(32, 122), 1);
}

TEST(PullPush, KnowsNothingWhenNothingIsTrusted) {
  const cv::Mat values(20, 30, CV_32F, cv::Scalar(3)), nothing = cv::Mat::zeros(20, 30, CV_32F);
  EXPECT_EQ(cv::norm(pull_push(values, nothing), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace freshet::synth::sampling
