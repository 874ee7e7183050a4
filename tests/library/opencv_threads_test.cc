#include "library/opencv_threads.h"

#include <gtest/gtest.h>

#include <memory>

#include <opencv2/core/utility.hpp>

namespace freshet {
namespace {

TEST(OneOpenCvThread, HoldsOpenCvToOneUntilTheLastOfThemGoes) {
  cv::setNumThreads(2);
  auto first = std::make_unique<OneOpenCvThread>();
  auto second = std::make_unique<OneOpenCvThread>();
  EXPECT_EQ(cv::getNumThreads(), 1);
  first.reset();
  EXPECT_EQ(cv::getNumThreads(), 1);
  second.reset();
  EXPECT_EQ(cv::getNumThreads(), 2);
}

}  // namespace
}  // namespace freshet
