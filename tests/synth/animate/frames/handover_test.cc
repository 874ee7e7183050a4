#include "synth/animate/frames/handover.h"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace freshet::synth::animate {
namespace {

cv::Mat numbered(int number) { return cv::Mat(1, 1, CV_32S, cv::Scalar(number)); }

TEST(Handover, FramesComeInOrder) {
  std::vector<int> came;
  const std::function<void(const cv::Mat&)> sink = [&](const cv::Mat& frame) {
    came.push_back(frame.at<int>(0));
  };
  {
    Handover handover(sink);
    for (int batch = 0; batch < 50; ++batch) handover.take({numbered(2 * batch), numbered(2 * batch + 1)});
    handover.wait();
  }
  ASSERT_EQ(came.size(), 100u);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(came[static_cast<std::size_t>(i)], i);
}

TEST(Handover, TheNextCallThrowsWhatTheSinkThrew) {
  const std::function<void(const cv::Mat&)> sink = [](const cv::Mat&) {
    throw std::runtime_error("disk full");
  };
  Handover handover(sink);
  handover.take({numbered(0)});
  EXPECT_THROW(handover.take({numbered(1)}), std::runtime_error);
}

TEST(Handover, LeftByAnExceptionItStillHandsOnWhatItTook) {
  int came = 0;
  const std::function<void(const cv::Mat&)> sink = [&](const cv::Mat&) { ++came; };
  try {
    Handover handover(sink);
    handover.take({numbered(0), numbered(1)});
    throw std::runtime_error("elsewhere");
  } catch (const std::runtime_error&) {
  }
  EXPECT_EQ(came, 2);
}

}  // namespace
}  // namespace freshet::synth::animate
