// Animations longer than any clip, and such as have no end.

#include <gtest/gtest.h>

#include <algorithm>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kLong = 100;  // frames; the sample's clips have 32 and 40

std::vector<cv::Mat> animate(const WorkFolder& folder, const std::string& name,
                             std::vector<std::string> more) {
  fs::create_directories(folder / name);
  std::vector<std::string> arguments{"synth",   "animate",      sample().store, sample().still,
                                     "--matte", sample().matte, "-o",           name + "/%05d.png"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = folder.freshet(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("left out"), std::string::npos) << outcome.err;
  return read_frames(folder / name);
}

/// Mean absolute difference of each frame to the next; of the last to the first.
std::vector<double> steps(const std::vector<cv::Mat>& frames) {
  std::vector<double> out;
  for (std::size_t i = 0; i < frames.size(); ++i)
    out.push_back(cv::norm(frames[i], frames[(i + 1) % frames.size()], cv::NORM_L1) /
                  static_cast<double>(frames[i].total()));
  return out;
}

TEST(Loop, RunsFromItsLastFrameIntoItsFirstWithoutASeam) {
  const WorkFolder folder;
  const std::vector<cv::Mat> frames = animate(folder, "loop", {"--frames", std::to_string(kLong), "--loop"});
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(kLong));
  std::vector<double> all = steps(frames);
  const double seam = all.back();
  all.pop_back();
  std::sort(all.begin(), all.end());
  const double median = all[all.size() / 2];
  EXPECT_GT(median, 0);
  EXPECT_LE(seam, median);
  EXPECT_LE(all.back(), 3 * median);
}

TEST(Loop, ClipsThatEndTooSoonGoOnByTheirLoopRules) {
  const WorkFolder folder;
  const std::vector<cv::Mat> frames = animate(folder, "long", {"--frames", std::to_string(kLong)});
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(kLong));
  std::vector<double> all = steps(frames);
  all.pop_back();  // its last frame need not be followed by the first
  EXPECT_GT(*std::min_element(all.begin(), all.end()), 0);
  std::sort(all.begin(), all.end());
  EXPECT_LE(all.back(), 3 * all[all.size() / 2]);
}

TEST(Loop, FramesAreTheSameForAnyMemoryAndThreads) {
  const WorkFolder folder;
  const std::vector<std::string> options{"--frames", std::to_string(kLong), "--loop", "--speed", "0.7"};
  const auto with = [&](const std::string& name, const char* memory, const char* threads) {
    std::vector<std::string> all = options;
    all.insert(all.end(), {"--memory", memory, "-j", threads});
    return animate(folder, name, all);
  };
  const std::vector<cv::Mat> whole = with("whole", "1500", "2"), batches = with("batches", "1", "1");
  ASSERT_EQ(whole.size(), static_cast<std::size_t>(kLong));
  ASSERT_EQ(batches.size(), whole.size());
  for (int i = 0; i < kLong; ++i) EXPECT_EQ(cv::norm(whole[i], batches[i], cv::NORM_INF), 0) << i;
}

TEST(Loop, AskedOfAClipTooShortToHaveOneIsRefusedByItsName) {
  const WorkFolder folder;
  fs::create_directories(folder / "clips");
  ASSERT_EQ(folder
                .freshet({"synth", "simulate", "waterfall", "--size", "192x144", "--frames", "12", "-o",
                          "clips/short.mkv"})
                .exit_code,
            0);
  const Outcome ingested = folder.freshet({"ingest", "short.store", "clips", "--force"});
  ASSERT_EQ(ingested.exit_code, 0) << ingested.err;
  const auto animated = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"synth",   "animate", "short.store", sample().still,
                                       "--whole", "-o",      "out.mkv",     "--overwrite"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return folder.freshet(arguments);
  };
  const Outcome looped = animated({"--frames", "8", "--loop"});
  EXPECT_EQ(looped.exit_code, 1);
  EXPECT_NE(looped.err.find("short.mkv: the clip has 12 frames"), std::string::npos) << looped.err;
  EXPECT_NE(looped.err.find("20 frames are needed"), std::string::npos) << looped.err;
  const Outcome lengthened = animated({"--frames", "50"});
  EXPECT_EQ(lengthened.exit_code, 1);
  EXPECT_NE(lengthened.err.find("none with a loop rule"), std::string::npos) << lengthened.err;
  EXPECT_EQ(animated({"--frames", "12"}).exit_code, 0);

  // Beside a clip that has one it is left out, and named.
  fs::create_directories(folder / "more");
  fs::copy_file(sample().clips / "fall/1.mkv", folder / "more/fall.mkv");
  ASSERT_EQ(folder.freshet({"ingest", "short.store", "more"}).exit_code, 0);
  const Outcome beside = animated({"--frames", "50"});
  EXPECT_EQ(beside.exit_code, 0) << beside.err;
  EXPECT_NE(beside.err.find("have no loop rule: short.mkv"), std::string::npos) << beside.err;
}

TEST(Loop, OfOneFrameIsRefused) {
  const WorkFolder folder;
  const Outcome outcome = folder.freshet({"synth", "animate", sample().store, sample().still, "--matte",
                                          sample().matte, "--loop", "--frames", "1", "-o", "out.mkv"});
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_NE(outcome.err.find("--frames"), std::string::npos) << outcome.err;
}

TEST(Loop, ARetimingMapOfAnotherSizeIsRefused) {
  const WorkFolder folder;
  cv::imwrite(folder / "map.png", cv::Mat(20, 30, CV_8U, cv::Scalar(90)));
  const Outcome outcome = folder.freshet({"synth", "animate", sample().store, sample().still, "--whole",
                                          "--frames", "8", "--retiming-map", "map.png", "-o", "out.mkv"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("30 x 20 px, the picture 192 x 144"), std::string::npos) << outcome.err;
}

TEST(Loop, SlowMotionMovesLessFromFrameToFrame) {
  const WorkFolder folder;
  const auto middle = [](std::vector<double> all) {
    all.pop_back();
    std::sort(all.begin(), all.end());
    return all[all.size() / 2];
  };
  const double once = middle(steps(animate(folder, "once", {"--frames", "16"})));
  const double slow = middle(steps(animate(folder, "slow", {"--frames", "16", "--speed", "0.25"})));
  cv::imwrite(folder / "black.png", cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(0)));
  const double half =
      middle(steps(animate(folder, "half", {"--frames", "16", "--retiming-map", "black.png"})));
  EXPECT_LT(slow, 0.7 * once);
  EXPECT_GT(slow, 0);
  EXPECT_LT(half, 0.95 * once);
  EXPECT_GT(half, slow);
}

}  // namespace
}  // namespace freshet::tools
