// synth animate --boundary moving, from end to end.

#include <gtest/gtest.h>

#include <algorithm>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kAnimated = 12;

Outcome animate(const WorkFolder& folder, const std::string& name, std::vector<std::string> more) {
  fs::create_directories(folder / name);
  std::vector<std::string> arguments{"synth",        "animate",         sample().store,
                                     sample().still, "--frames",        std::to_string(kAnimated),
                                     "-o",           name + "/%05d.png"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return folder.freshet(arguments);
}

TEST(MovingBoundary, TheMatteMovesKeepsItsAreaAndIsWhereTheFrameDiffersFromThePicture) {
  const WorkFolder folder;
  for (const std::string threads : {"1", "2"}) {
    fs::create_directories(folder / ("mattes" + threads));
    const Outcome outcome = animate(folder, "frames" + threads,
                                    {"--matte", sample().matte, "--boundary", "moving", "-j", threads,
                                     "--matte-out", "mattes" + threads + "/%05d.png"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "frames" + threads + "/%05d.png\nmattes" + threads + "/%05d.png\n");
  }
  cv::Mat matte = cv::imread(sample().matte, cv::IMREAD_GRAYSCALE);
  matte.setTo(0, matte < 8);  // what is nearly black stands still
  const cv::Mat still = cv::imread(sample().still, cv::IMREAD_COLOR);
  const auto frames = read_frames(folder / "frames1", cv::IMREAD_COLOR),
             again = read_frames(folder / "frames2", cv::IMREAD_COLOR),
             mattes = read_frames(folder / "mattes1", cv::IMREAD_GRAYSCALE);
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(kAnimated));
  ASSERT_EQ(again.size(), frames.size());
  ASSERT_EQ(mattes.size(), frames.size());
  const double area = cv::sum(matte)[0];
  EXPECT_EQ(cv::norm(mattes[0], matte, cv::NORM_INF), 0) << "the first is the still one";
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_NEAR(cv::sum(mattes[i])[0], area, 0.01 * area) << "frame " << i;
    EXPECT_EQ(cv::norm(frames[i], again[i], cv::NORM_INF), 0) << "one thread and two differ in frame " << i;
    if (i > 0) {
      EXPECT_GT(cv::norm(mattes[i], mattes[i - 1], cv::NORM_INF), 0) << "frame " << i;
    }
    const cv::Mat neither = (matte == 0) & (mattes[i] == 0);
    ASSERT_GT(cv::countNonZero(neither), 100);
    EXPECT_LE(cv::norm(frames[i], still, cv::NORM_INF, neither), 1) << "frame " << i;
  }
}

TEST(MovingBoundary, TheFirstFrameIsTheStill) {
  const WorkFolder folder;
  // Half seen through everywhere: what is guessed behind it would show.
  cv::Mat thin = cv::imread(sample().matte, cv::IMREAD_GRAYSCALE) * 0.6;
  cv::imwrite(folder / "thin.png", thin);
  const cv::Mat still = cv::imread(sample().still, cv::IMREAD_COLOR);
  for (const char* name : {"once", "loop"}) {
    std::vector<std::string> more{"--matte", "thin.png", "--boundary", "moving"};
    if (name == std::string("loop")) more.push_back("--loop");
    const Outcome outcome = animate(folder, name, more);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto frames = read_frames(folder / name, cv::IMREAD_COLOR);
    const cv::Mat within = thin > 8;
    const auto off = [&](const cv::Mat& frame) {
      return cv::norm(frame, still, cv::NORM_L1, within) / (3.0 * cv::countNonZero(within));
    };
    EXPECT_LT(off(frames[0]), 2) << name;
    EXPECT_GT(off(frames[kAnimated / 2]), 2 * off(frames[0])) << name;
  }
}

TEST(MovingBoundary, ABackgroundOfAnotherSizeIsRefusedByName) {
  const WorkFolder folder;
  cv::imwrite(folder / "small.png", cv::Mat::zeros(10, 20, CV_8UC3));
  const Outcome outcome = animate(
      folder, "frames", {"--matte", sample().matte, "--boundary", "moving", "--background", "small.png"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("small.png"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("20 x 10"), std::string::npos) << outcome.err;
}

TEST(MovingBoundary, AMatteThatCoversEverythingNeedsABackground) {
  const WorkFolder folder;
  const Outcome without = animate(folder, "frames", {"--whole", "--boundary", "moving"});
  EXPECT_EQ(without.exit_code, 1);
  EXPECT_NE(without.err.find("--background"), std::string::npos) << without.err;
  EXPECT_TRUE(fs::is_empty(folder / "frames"));
  const Outcome with =
      animate(folder, "frames", {"--whole", "--boundary", "moving", "--background", sample().still});
  EXPECT_EQ(with.exit_code, 0) << with.err;
}

TEST(MovingBoundary, OptionsOfAMovingOutlineAreRefusedWithAStillOne) {
  const WorkFolder folder;
  const Outcome outcome = animate(folder, "frames", {"--whole", "--tau", "0.5"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--boundary moving"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace freshet::tools
