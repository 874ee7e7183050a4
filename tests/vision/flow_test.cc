#include "vision/flow.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"

namespace freshet::vision {
namespace {

class Flow : public testing::Test {
 protected:
  void SetUp() override { cv::setNumThreads(1); }  // as the executable does
};

// Smooth noise, the same at a place whatever the picture's size and offset.
cv::Mat texture(cv::Size size, cv::Point offset) {
  cv::Mat noise(400, 400, CV_8U), part;
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(noise, noise, {}, 1.5);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  return noise(cv::Rect(offset, size)).clone();
}

TEST_F(Flow, FindsAKnownShift) {
  const cv::Size size(160, 120);
  for (const FlowMethod method : {FlowMethod::kDis, FlowMethod::kTvL1}) {
    // The picture's content moves by (+2, -1): what was at p is at p + (2, -1).
    const cv::Mat flow = optical_flow(texture(size, {50, 50}), texture(size, {48, 51}), {.method = method});
    ASSERT_EQ(flow.type(), CV_32FC2);
    ASSERT_EQ(flow.size(), size);
    const cv::Scalar mean = cv::mean(flow(cv::Rect(16, 16, 128, 88)));
    EXPECT_NEAR(mean[0], 2, 0.1);
    EXPECT_NEAR(mean[1], -1, 0.1);
  }
}

TEST_F(Flow, SurvivesSmallAndOddFrames) {
  for (const cv::Size size : {cv::Size(16, 16), cv::Size(17, 33), cv::Size(48, 16), cv::Size(16, 700),
                              cv::Size(121, 67), cv::Size(65, 64)}) {
    const cv::Mat from = size.height > 300 ? cv::Mat(size, CV_8U, cv::Scalar(9)) : texture(size, {50, 50});
    const cv::Mat to = size.height > 300 ? from : texture(size, {49, 50});
    for (const FlowMethod method : {FlowMethod::kDis, FlowMethod::kTvL1}) {
      const cv::Mat flow = optical_flow(from, to, {.method = method, .tvl1_iterations = 3, .tvl1_warps = 2});
      EXPECT_EQ(flow.size(), size);
      EXPECT_TRUE(cv::checkRange(flow, true, nullptr, -100, 100));
    }
  }
}

TEST_F(Flow, IsTheSameOnAnyNumberOfThreads) {
  const cv::Mat from = texture({200, 150}, {50, 50}), to = texture({200, 150}, {47, 52});
  const cv::Mat alone = optical_flow(from, to);
  for (const std::size_t threads : {1, 2, 8}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    std::vector<cv::Mat> flows(8);
    oneapi::tbb::parallel_for(0, 8, [&](int i) { flows[i] = optical_flow(from, to); });
    for (const cv::Mat& flow : flows) EXPECT_EQ(cv::norm(flow, alone, cv::NORM_INF), 0) << threads;
  }
}

TEST_F(Flow, RefusesWhatIsNotTwoFramesOfOneSize) {
  const cv::Mat small(15, 40, CV_8U, cv::Scalar(0)), grey(40, 40, CV_8U, cv::Scalar(0)),
      colour(40, 40, CV_8UC3);
  EXPECT_THROW(optical_flow(small, small), Error);
  EXPECT_THROW(optical_flow(grey, small), Error);
  EXPECT_THROW(optical_flow(colour, colour), Error);
  EXPECT_THROW(parse_flow_method("farneback"), Error);
  EXPECT_EQ(parse_flow_method("tv-l1"), FlowMethod::kTvL1);
}

TEST(QuantizeFlow, AveragesBlocksAndKeepsTheUnitOfTheSource) {
  cv::Mat flow(5, 7, CV_32FC2), u, v;
  cv::RNG(3).fill(flow, cv::RNG::UNIFORM, -20, 20);
  quantize_flow(flow, 2, u, v);
  ASSERT_EQ(u.type(), CV_16SC1);
  ASSERT_EQ(u.size(), cv::Size(4, 3));
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 4; ++x) {
      double sum_u = 0, sum_v = 0;
      for (int i = 0; i < 4; ++i) {
        const auto& p = flow.at<cv::Vec2f>(std::min(4, 2 * y + i / 2), std::min(6, 2 * x + i % 2));
        sum_u += p[0];
        sum_v += p[1];
      }
      EXPECT_NEAR(u.at<short>(y, x) * kFlowUnit, sum_u / 4, 0.51 * kFlowUnit);
      EXPECT_NEAR(v.at<short>(y, x) * kFlowUnit, sum_v / 4, 0.51 * kFlowUnit);
    }
  }
}

TEST(QuantizeFlow, Saturates) {
  const cv::Mat flow(4, 4, CV_32FC2, cv::Scalar(1e6, -1e6));
  cv::Mat u, v;
  quantize_flow(flow, 1, u, v);
  EXPECT_EQ(u.at<short>(0, 0), 32767);
  EXPECT_EQ(v.at<short>(3, 3), -32768);
}

}  // namespace
}  // namespace freshet::vision
