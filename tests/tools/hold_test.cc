// --hold, from end to end: what stands in front of the fluid does not go along.

#include <gtest/gtest.h>

#include <algorithm>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kAnimated = 8;

// A bar across the fluid, its edge soft.
cv::Mat bar() {
  cv::Mat held(kHeight, kWidth, CV_8U, cv::Scalar(0));
  for (int y = 0; y < kHeight; ++y) {
    const int outside = std::max({0, 60 - y, y - 90});
    held.row(y).setTo(std::max(0, 255 - 64 * outside));
  }
  return held;
}

Outcome animate(const WorkFolder& folder, const std::string& name, std::vector<std::string> more) {
  fs::create_directories(folder / name);
  std::vector<std::string> arguments{"synth",   "animate",         sample().store, sample().still,
                                     "--matte", sample().matte,    "--frames",     std::to_string(kAnimated),
                                     "-o",      name + "/%05d.png"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return folder.freshet(arguments);
}

TEST(Hold, WhatIsHeldIsThePictureToTheBitAndTheRestMoves) {
  const WorkFolder folder;
  const cv::Mat held = bar();
  cv::imwrite(folder / "held.png", held);
  const cv::Mat still = cv::imread(sample().still, cv::IMREAD_COLOR);
  const cv::Mat fluid = cv::imread(sample().matte, cv::IMREAD_GRAYSCALE) > 200;
  for (const std::string method : {"carried", "paper"}) {
    const Outcome outcome = animate(folder, method, {"--hold", "held.png", "--method", method});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("of the matte is held back"), std::string::npos) << outcome.err;
    const auto frames = read_frames(folder / method, cv::IMREAD_COLOR);
    ASSERT_EQ(frames.size(), static_cast<std::size_t>(kAnimated));
    for (std::size_t i = 1; i < frames.size(); ++i) {
      EXPECT_EQ(cv::norm(frames[i], still, cv::NORM_INF, held == 255), 0) << method << ", frame " << i;
      EXPECT_GT(cv::norm(frames[i], still, cv::NORM_INF, fluid & (held == 0)), 8)
          << method << ", frame " << i;
    }
  }
}

TEST(Hold, AMovingOutlineGoesBehindWhatIsHeld) {
  const WorkFolder folder;
  const cv::Mat held = bar();
  cv::imwrite(folder / "held.png", held);
  fs::create_directories(folder / "mattes");
  const Outcome outcome = animate(
      folder, "frames", {"--hold", "held.png", "--boundary", "moving", "--matte-out", "mattes/%05d.png"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const cv::Mat still = cv::imread(sample().still, cv::IMREAD_COLOR);
  const auto frames = read_frames(folder / "frames", cv::IMREAD_COLOR),
             mattes = read_frames(folder / "mattes", cv::IMREAD_GRAYSCALE);
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(kAnimated));
  ASSERT_EQ(mattes.size(), frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(cv::norm(mattes[i], cv::NORM_INF, held == 255), 0) << "frame " << i;
    EXPECT_EQ(cv::norm(frames[i], still, cv::NORM_INF, held == 255), 0) << "frame " << i;
  }
}

TEST(Hold, AutoKeepsThePicturesOwnFrameStill) {
  const WorkFolder folder;
  cv::Mat still = cv::imread(sample().still, cv::IMREAD_COLOR), frame(still.size(), CV_8U, cv::Scalar(0));
  frame.rowRange(still.rows - 2, still.rows).setTo(255);
  still.setTo(cv::Scalar(200, 210, 220), frame);
  cv::imwrite(folder / "framed.png", still);
  cv::Mat matte = cv::imread(sample().matte, cv::IMREAD_GRAYSCALE);
  matte.rowRange(still.rows / 2, still.rows).setTo(255);
  cv::imwrite(folder / "whole.png", matte);
  const auto moved = [&](const std::string& name, std::vector<std::string> more) {
    fs::create_directories(folder / name);
    std::vector<std::string> arguments{
        "synth",   "animate",         sample().store, "framed.png",
        "--matte", "whole.png",       "--frames",     std::to_string(kAnimated),
        "-o",      name + "/%05d.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = folder.freshet(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err.find("--hold auto: ") != std::string::npos, !more.empty()) << outcome.err;
    double most = 0;
    for (const cv::Mat& shown : read_frames(folder / name, cv::IMREAD_COLOR))
      most = std::max(most, cv::norm(shown, still, cv::NORM_INF, frame));
    return most;
  };
  EXPECT_GT(moved("plain", {}), 8);
  EXPECT_EQ(moved("held", {"--hold", "auto"}), 0);
}

TEST(Hold, AMatteThatHoldsAllOrHasAnotherSizeIsRefusedByName) {
  const WorkFolder folder;
  cv::imwrite(folder / "all.png", cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(255)));
  const Outcome all = animate(folder, "frames", {"--hold", "all.png"});
  EXPECT_EQ(all.exit_code, 1);
  EXPECT_NE(all.err.find("all.png"), std::string::npos) << all.err;
  cv::imwrite(folder / "small.png", cv::Mat(10, 20, CV_8U, cv::Scalar(255)));
  const Outcome small = animate(folder, "frames", {"--hold", "small.png"});
  EXPECT_EQ(small.exit_code, 1);
  EXPECT_NE(small.err.find("small.png"), std::string::npos) << small.err;
  EXPECT_TRUE(fs::is_empty(folder / "frames"));
}

}  // namespace
}  // namespace freshet::tools
